// SPDX-License-Identifier: BSD-3-Clause
#include "orb/orb.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "features/test_images.hpp"

namespace holdfast {
namespace {

Features extract(const cv::Mat& image, const OrbSettings& settings = {}, SimdLevel level = simd_level()) {
  OrbExtractor extractor(settings, {}, level);
  Features features;
  extractor.extract(image, cv::Mat(), features);
  return features;
}

void expect_same(const Features& a, const Features& b) {
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.y, b.y);
  EXPECT_EQ(a.angle, b.angle);
  EXPECT_EQ(a.response, b.response);
  EXPECT_EQ(a.octave, b.octave);
  EXPECT_EQ(a.descriptors, b.descriptors);
}

/// How features of an image fare in the image moved by a known transform.
struct Repeat {
  int near = 0;              ///< have a feature near where they should be, at the same or a neighbouring level
  int described = 0;         ///< of those, with a descriptor within 50 bits
  int oriented = 0;          ///< of those, with an orientation that turned along within 15 degrees
  double mean_distance = 0;  ///< of positions of level 0, of those that are near [px]
};

Repeat repeat(const Features& a, const Features& b, const cv::Matx23d& transform, double turned_by) {
  Repeat result;
  int fine = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double x = transform(0, 0) * a.x[i] + transform(0, 1) * a.y[i] + transform(0, 2);
    const double y = transform(1, 0) * a.x[i] + transform(1, 1) * a.y[i] + transform(1, 2);
    double nearest = 2.0 * std::pow(1.2, a.octave[i]);
    std::size_t partner = b.size();
    for (std::size_t j = 0; j < b.size(); ++j)
      if (const double distance = std::hypot(b.x[j] - x, b.y[j] - y); b.octave[j] == a.octave[i] && distance < nearest)
        nearest = distance, partner = j;
    if (partner == b.size()) continue;
    ++result.near;
    result.described += hamming_distance(a.descriptors.of_256_bits()[i], b.descriptors.of_256_bits()[partner]) <= 50;
    const double turn = std::remainder(b.angle[partner] - a.angle[i] - turned_by, 2 * std::numbers::pi);
    result.oriented += std::abs(turn) < 15 * std::numbers::pi / 180;
    if (a.octave[i] == 0) result.mean_distance += nearest, ++fine;
  }
  result.mean_distance /= std::max(1, fine);
  return result;
}

/// The transform for cv::warpAffine that turns from the x axis towards the y axis and then shifts.
cv::Matx23d turn_and_shift(cv::Size size, double angle, double shift_x, double shift_y) {
  const double cosine = std::cos(angle), sine = std::sin(angle), x = size.width / 2.0, y = size.height / 2.0;
  return {cosine, -sine, x - cosine * x + sine * y + shift_x, sine, cosine, y - sine * x - cosine * y + shift_y};
}

TEST(Orb, IsTheSameAtEverySimdLevel) {
  for (const cv::Mat& image : {test::scene_image(333, 251, 1), test::noise_image(150, 97, 2),
                               test::scene_image(400, 300, 3)(cv::Rect(31, 17, 301, 211))}) {
    const Features expected = extract(image, {}, SimdLevel::scalar);
    ASSERT_GT(expected.size(), 100U);
    for (const SimdLevel level : test::available_simd_levels()) {
      SCOPED_TRACE(to_string(level));
      expect_same(extract(image, {}, level), expected);
    }
  }
}

TEST(Orb, GivesExactlyTheCountWhereThereAreEnoughCorners) {
  const cv::Mat image = test::scene_image(640, 480, 4);
  for (const int count : {50, 333, 1000}) {
    OrbSettings settings;
    settings.count = count;
    EXPECT_EQ(extract(image, settings).size(), static_cast<std::size_t>(count));
  }
}

TEST(Orb, ABudgetMultipliesTheCount) {
  const cv::Mat image = test::scene_image(640, 480, 4);
  OrbSettings settings;
  settings.count = 400;
  OrbExtractor extractor(settings);
  Features features;
  for (const auto& [budget, count] : {std::pair{1.5, 600U}, std::pair{2.0, 800U}, std::pair{1.0, 400U}}) {
    extractor.set_budget(budget);
    extractor.extract(image, cv::Mat(), features);
    EXPECT_EQ(features.size(), count);
  }
}

TEST(Orb, FeaturesTurnWithTheImage) {
  const cv::Mat image = test::scene_image(480, 480, 5);
  const Features features = extract(image);
  for (const double degrees : {30.0, 90.0, 200.0}) {
    const double angle = degrees * std::numbers::pi / 180;
    const cv::Matx23d transform = turn_and_shift(image.size(), angle, 0, 0);
    cv::Mat turned;
    cv::warpAffine(image, turned, transform, image.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT_101);
    const Repeat found = repeat(features, extract(turned), transform, angle);
    EXPECT_GT(found.near, 200) << degrees;
    EXPECT_GT(found.oriented, 0.85 * found.near) << degrees;
    EXPECT_GT(found.described, 0.75 * found.near) << degrees;
  }
}

TEST(Orb, DescriptorsOfDifferentFeaturesDiffer) {
  const Features features = extract(test::scene_image(480, 360, 6));
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < features.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (std::hypot(features.x[i] - features.x[j], features.y[i] - features.y[j]) > 60)
        sum += hamming_distance(features.descriptors.of_256_bits()[i], features.descriptors.of_256_bits()[j]), ++count;
  EXPECT_GT(sum / count, 100);
}

TEST(Orb, SubpixelPositionsFollowASubpixelShift) {
  const cv::Mat image = test::scene_image(480, 360, 7);
  const cv::Matx23d transform = turn_and_shift(image.size(), 0, 0.5, 0.4);
  cv::Mat shifted;
  cv::warpAffine(image, shifted, transform, image.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT_101);
  OrbSettings whole;
  whole.subpixel = false;
  const Repeat refined = repeat(extract(image), extract(shifted), transform, 0);
  const Repeat unrefined = repeat(extract(image, whole), extract(shifted, whole), transform, 0);
  EXPECT_GT(refined.near, 300);
  EXPECT_LT(refined.mean_distance, 0.6 * unrefined.mean_distance);
}

TEST(Orb, LevelsAgreeOnWhereAThingIs) {
  // A small symmetric disc is found at several levels, always at its centre, wherever that lies between the pixels.
  cv::Mat image(240, 320, CV_8UC1, cv::Scalar(60));
  constexpr int shift = 4;
  const cv::Point2d centre(161.25, 119.5);
  cv::circle(image, {static_cast<int>(centre.x * 16), static_cast<int>(centre.y * 16)}, 4 * 16, cv::Scalar(220),
             cv::FILLED, cv::LINE_AA, shift);
  cv::GaussianBlur(image, image, {5, 5}, 1.0);
  const Features features = extract(image);
  int coarse = 0;
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (features.octave[i] < 4) continue;
    ++coarse;
    EXPECT_NEAR(features.x[i], centre.x, 0.6) << static_cast<int>(features.octave[i]);
    EXPECT_NEAR(features.y[i], centre.y, 0.6) << static_cast<int>(features.octave[i]);
  }
  EXPECT_GE(coarse, 2);
}

TEST(Orb, SpreadReachesMoreOfTheImage) {
  // Strong texture in a quarter, faint texture elsewhere.
  cv::Mat image = test::scene_image(640, 480, 8);
  cv::Mat rest = image(cv::Rect(320, 0, 320, 480)), lower = image(cv::Rect(0, 240, 320, 240));
  rest.convertTo(rest, CV_8U, 0.25, 96);
  lower.convertTo(lower, CV_8U, 0.25, 96);
  const auto cells = [&](double share) {
    OrbSettings settings;
    settings.spread = share;
    std::vector<bool> occupied(300);
    const Features features = extract(image, settings);
    for (std::size_t i = 0; i < features.size(); ++i)
      occupied[static_cast<std::size_t>(features.y[i] / 32) * 20 + static_cast<std::size_t>(features.x[i] / 32)] = true;
    return std::count(occupied.begin(), occupied.end(), true);
  };
  EXPECT_GT(cells(0.4), 1.4 * cells(0.0));
  EXPECT_GT(cells(1.0), cells(0.4));
}

TEST(Orb, DoesNotChangeTheImage) {
  const cv::Mat image = test::scene_image(200, 150, 9), copy = image.clone();
  extract(image);
  EXPECT_EQ(cv::norm(image, copy, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace holdfast
