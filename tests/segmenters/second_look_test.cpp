// SPDX-License-Identifier: BSD-3-Clause
#include "second_look.hpp"

#include <gtest/gtest.h>

#include <array>
#include <opencv2/core.hpp>

namespace holdfast::unet_plugin {
namespace {

constexpr int classes = 3, person = 1;
const cv::Size input(192, 144), cells(96, 72), image(640, 480);

/// Scores of a network that sees background everywhere: with a lead of 20, beyond doubt.
cv::Mat certain_scores(cv::Size size = cells) {
  const std::array<int, 4> sizes{1, classes, size.height, size.width};
  cv::Mat scores(4, sizes.data(), CV_32F, cv::Scalar(0.0));
  cv::Mat(size, CV_32F, scores.ptr<float>(0, 0)).setTo(20.0F);
  return scores;
}

cv::Mat doubt_at(const cv::Rect& doubtful) {
  cv::Mat scores = certain_scores();
  cv::Mat(cells, CV_32F, scores.ptr<float>(0, 0))(doubtful).setTo(0.5F);
  return scores;
}

TEST(SecondLook, ShowsThePartOfTheImageThatIsInDoubt) {
  SecondLook look;
  for (const cv::Rect& doubtful : {cv::Rect(0, 0, 20, 20), cv::Rect(76, 52, 20, 20), cv::Rect(40, 30, 20, 20)}) {
    const auto window = look.begin(doubt_at(doubtful), image, input, person);
    ASSERT_TRUE(window.has_value()) << doubtful;
    const double pixels = static_cast<double>(image.width) / cells.width;
    // To a step of the search.
    EXPECT_LE(window->x, pixels * (doubtful.x + 4)) << doubtful;
    EXPECT_LE(window->y, pixels * (doubtful.y + 4)) << doubtful;
    EXPECT_GE(window->br().x, pixels * (doubtful.br().x - 4)) << doubtful;
    EXPECT_GE(window->br().y, pixels * (doubtful.br().y - 4)) << doubtful;
    EXPECT_EQ(*window & cv::Rect(cv::Point(), image), *window) << doubtful;
    EXPECT_NEAR(window->width, 0.6 * image.width, 2.0);
    EXPECT_NEAR(window->height, 0.6 * image.height, 2.0);
  }
}

TEST(SecondLook, BothLooksDecideInTheWindowAndTheFirstElsewhere) {
  SecondLook look;
  const auto window = look.begin(doubt_at({0, 0, 20, 20}), image, input, person);
  ASSERT_TRUE(window.has_value());
  cv::Mat second = certain_scores();
  second.setTo(-3.0F);
  const cv::Mat& both = look.combine(second);
  ASSERT_EQ(both.dims, 4);
  const int rows = both.size[2], columns = both.size[3];
  // A cell has as many pixels as one of the second look.
  EXPECT_NEAR(static_cast<double>(image.width) / columns, static_cast<double>(window->width) / cells.width, 0.05);
  const auto background_at = [&](double x, double y) {
    return both.ptr<float>(0, 0,
                           static_cast<int>(y * rows / image.height))[static_cast<int>(x * columns / image.width)];
  };
  EXPECT_FLOAT_EQ(background_at(20, 20), 0.5F * (0.5F - 3.0F));
  EXPECT_FLOAT_EQ(background_at(window->br().x - 20, window->br().y - 20), 0.5F * (20.0F - 3.0F));
  EXPECT_FLOAT_EQ(background_at(window->br().x + 20, window->br().y + 20), 20.0F);
}

TEST(SecondLook, TheFirstDimensionMayBeMissing) {
  SecondLook four, three;
  cv::Mat scores = doubt_at({40, 30, 20, 20});
  const std::array<int, 3> sizes{classes, cells.height, cells.width};
  const cv::Mat short_scores(3, sizes.data(), CV_32F, scores.data);
  const auto window = three.begin(short_scores, image, input, person);
  EXPECT_EQ(window, four.begin(scores, image, input, person));
  ASSERT_TRUE(window.has_value());
  EXPECT_EQ(cv::norm(three.combine(short_scores), four.combine(scores), cv::NORM_INF), 0.0);
}

TEST(SecondLook, IsNotTakenWithoutDoubt) { EXPECT_FALSE(SecondLook().begin(certain_scores(), image, input, person)); }

TEST(SecondLook, IsNotTakenAtImagesThatHoldNoMoreThanTheFirstSaw) {
  SecondLook look;
  const cv::Mat scores = doubt_at({0, 0, 96, 72});
  EXPECT_FALSE(look.begin(scores, input, input, person));
  EXPECT_TRUE(look.begin(scores, {240, 180}, input, person));
}

TEST(SecondLook, DoesNotEnlargePixels) {
  const auto window = SecondLook().begin(doubt_at({0, 0, 96, 72}), {240, 180}, input, person);
  ASSERT_TRUE(window.has_value());
  EXPECT_EQ(window->size(), input);
}

}  // namespace
}  // namespace holdfast::unet_plugin
