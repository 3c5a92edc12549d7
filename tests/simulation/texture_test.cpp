// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/texture.hpp"

#include <gtest/gtest.h>

#include <array>
#include <opencv2/core.hpp>

#include "holdfast/simulation/noise.hpp"

namespace holdfast::simulation {
namespace {

std::array<float, 4> sample(const Texture& texture, float u, float v, float level) {
  const float at_u[4] = {u}, at_v[4] = {v};
  std::array<float, 16> colours{};
  texture.sample(at_u, at_v, 1, {0.0F, 0.0F, 1, level}, colours.data());
  return {colours[0], colours[1], colours[2], colours[3]};
}

TEST(Texture, SamplesEachTexelInItsCentre) {
  cv::Mat picture(5, 7, CV_8UC3);
  cv::randu(picture, cv::Scalar::all(0), cv::Scalar::all(256));
  picture.at<cv::Vec3b>(2, 6) = {255, 255, 255};
  const Texture texture(picture);
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 7; ++x) {
      const auto colour = sample(texture, static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F, 0.0F);
      for (int c = 0; c < 3; ++c) EXPECT_EQ(colour[c], picture.at<cv::Vec3b>(y, x)[c]) << x << ' ' << y;
    }
}

TEST(Texture, IsLinearBetweenCentresAndNeverOverflows) {
  cv::Mat picture(64, 64, CV_8UC3);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) picture.at<cv::Vec3b>(y, x) = cv::Vec3b(x * 4, y * 4, 255);
  const Texture texture(picture);
  for (float v = 0.6F; v < 63.0F; v += 0.37F)
    for (float u = 0.6F; u < 63.0F; u += 0.41F) {
      const auto colour = sample(texture, u, v, 0.0F);
      EXPECT_NEAR(colour[0], 4.0F * (u - 0.5F), 1.0F);
      EXPECT_NEAR(colour[1], 4.0F * (v - 0.5F), 1.0F);
      EXPECT_EQ(colour[2], 255);
    }
}

TEST(Texture, CoarseLevelsKeepPlaceAndMean) {
  cv::Mat picture(128, 128, CV_8UC3);
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 128; ++x) picture.at<cv::Vec3b>(y, x) = cv::Vec3b(2 * x, 2 * y, (x + y) % 2 * 200);
  const Texture texture(picture);
  for (const float level : {1.0F, 1.5F, 2.0F, 2.7F, 3.0F}) {
    const auto colour = sample(texture, 50.0F, 70.0F, level);
    EXPECT_NEAR(colour[0], 99, 2) << level;
    EXPECT_NEAR(colour[1], 139, 2) << level;
    EXPECT_NEAR(colour[2], 100, 2) << level;
  }
  EXPECT_NEAR(sample(texture, 3.0F, 3.0F, 40.0F)[0], 127, 3);  // beyond the last level
}

TEST(Noise, QuickNormalHasTheMomentsOfANormalNumber) {
  Random random(3);
  double sum = 0, squares = 0, fourth = 0;
  constexpr int count = 200000;
  for (int i = 0; i < count; ++i) {
    const double value = quick_normal(static_cast<std::uint32_t>(random.next()));
    sum += value, squares += value * value, fourth += value * value * value * value;
  }
  EXPECT_NEAR(sum / count, 0.0, 0.01);
  EXPECT_NEAR(squares / count, 1.0, 0.01);
  EXPECT_NEAR(fourth / count, 3.0, 0.4);  // 2.7 by construction, 1.8 for a uniform number
}

}  // namespace
}  // namespace holdfast::simulation
