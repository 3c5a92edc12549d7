// SPDX-License-Identifier: BSD-3-Clause
#include "global_detector.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <opencv2/imgproc.hpp>
#include <string>

#include "holdfast/core/error.hpp"
#include "holdfast/core/random.hpp"

namespace holdfast::global_plugin {
namespace {

using ::testing::HasSubstr;

GlobalSettings settings(const std::string& model = HOLDFAST_PLACE_MODELS "/gist.onnx") {
  GlobalSettings settings;
  settings.model = model;
  settings.mean = {0.0, 0.0, 0.0};
  settings.standard_deviation = {1.0, 1.0, 1.0};
  return settings;
}

KeyFrameId id(std::uint32_t slot) { return {slot, 1}; }

/// A room: its own grey rectangles, shifted by some pixels.
cv::Mat room(std::uint64_t place, int shift = 0) {
  Random random(place);
  cv::Mat image(480, 640, CV_8UC3, cv::Scalar::all(120));
  for (int i = 0; i < 60; ++i) {
    const int x = static_cast<int>(random.below(600)), y = static_cast<int>(random.below(440));
    const int width = 20 + static_cast<int>(random.below(120)), height = 20 + static_cast<int>(random.below(120));
    cv::rectangle(image, {x + shift, y, width, height}, cv::Scalar::all(random.below(256)), cv::FILLED);
  }
  return image;
}

std::string refusal_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(GlobalDetector, FindsTheSamePlaceAmongMany) {
  GlobalDetector detector(settings());
  constexpr std::uint32_t places = 40;
  for (std::uint32_t i = 0; i < places; ++i) detector.add(id(i), detector.describe(room(i), {}));
  for (std::uint32_t i = 0; i < places; i += 3) {
    const auto matches = detector.query(detector.describe(room(i, 6), {}), 4);
    ASSERT_FALSE(matches.empty());
    EXPECT_EQ(matches[0].keyframe, id(i));
    EXPECT_GT(matches[0].score, 0.3);
    EXPECT_LE(matches[0].score, 1.0 + 1e-6);
  }
}

TEST(GlobalDetector, TheScoreIsOneForTheSameImageAndNothingBelowTheLimit) {
  GlobalSettings strict = settings();
  strict.minimum_similarity = 0.99;
  GlobalDetector detector(strict);
  for (std::uint32_t i = 0; i < 10; ++i) detector.add(id(i), detector.describe(room(i), {}));
  const auto matches = detector.query(detector.describe(room(4), {}), 10);
  ASSERT_EQ(matches.size(), 1U) << "other rooms are not as similar as that";
  EXPECT_NEAR(matches[0].score, 1.0, 1e-4);
}

TEST(GlobalDetector, PeopleAreNoPartOfAPlace) {
  GlobalDetector detector(settings());
  const cv::Mat image = room(3);
  const cv::Rect person(200, 100, 180, 380);
  cv::Mat moving = cv::Mat::zeros(image.size(), CV_8UC1), here = image.clone(), there = image.clone();
  moving(person) = 255;
  room(77)(person).copyTo(here(person));
  room(78)(person).copyTo(there(person));
  const DescriptorBlock one = detector.describe(here, moving), two = detector.describe(there, moving);
  EXPECT_TRUE(one == two);
  EXPECT_FALSE(one == detector.describe(here, {}));
  moving = 255;
  EXPECT_TRUE(detector.describe(here, moving).empty()) << "nothing of the place is seen";
}

TEST(GlobalDetector, GreyImagesAreDescribedAsColouredOnesWithoutColour) {
  GlobalDetector detector(settings());
  cv::Mat grey;
  cv::cvtColor(room(5), grey, cv::COLOR_BGR2GRAY);
  EXPECT_TRUE(detector.describe(grey, {}) == detector.describe(room(5), {}));
}

TEST(GlobalDetector, AKeyframeWithoutDescriptionIsNeverFound) {
  GlobalDetector detector(settings());
  detector.add(id(1), DescriptorBlock());
  detector.add(id(2), detector.describe(room(1), {}));
  detector.add(id(3), detector.describe(room(2), {}));
  const auto found = [&] {
    std::vector<KeyFrameId> keyframes;
    for (const PlaceMatch& match : detector.query(detector.describe(room(1), {}), 10))
      keyframes.push_back(match.keyframe);
    return keyframes;
  };
  EXPECT_EQ(found().front(), id(2));
  EXPECT_THAT(found(), ::testing::Not(::testing::Contains(id(1))));
  detector.remove(id(1));  // the last takes its place
  EXPECT_EQ(found().front(), id(2));
  detector.remove(id(2));
  EXPECT_THAT(found(), ::testing::Not(::testing::Contains(id(2))));
  EXPECT_TRUE(detector.query(DescriptorBlock(), 5).empty());
}

TEST(GlobalDetector, RefusesWhatCannotBe) {
  GlobalDetector detector(settings());
  EXPECT_EQ(detector.image_descriptor()->length, 384U);
  detector.add(id(1), detector.describe(room(1), {}));
  EXPECT_THAT(refusal_of([&] { detector.add(id(1), DescriptorBlock()); }), HasSubstr("is in the database"));
  EXPECT_THAT(refusal_of([&] { detector.add(id(2), DescriptorBlock(DescriptorType(), 1)); }),
              HasSubstr("256 bits (hamming); expected at most one of 384 float32 (cosine)"));
  EXPECT_THAT(refusal_of([] { GlobalDetector absent(settings("absent.onnx")); }), HasSubstr("absent.onnx"));
  EXPECT_THAT(
      refusal_of([] { GlobalDetector one(settings(HOLDFAST_PLACE_MODELS "/../../features/models/gradients.onnx")); }),
      HasSubstr("gradients.onnx: has an input of 1x1x?x?"));
}

}  // namespace
}  // namespace holdfast::global_plugin
