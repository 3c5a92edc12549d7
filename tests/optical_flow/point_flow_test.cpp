// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/optical_flow/point_flow.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "../support/picture.hpp"

namespace holdfast {
namespace {

/// Points on a grid, off the pixels' centres, expected where they were.
PointFlow grid(float first_x, float last_x, float first_y, float last_y) {
  PointFlow flow;
  for (float y = first_y; y <= last_y; y += 20.0F)
    for (float x = first_x; x <= last_x; x += 20.0F) flow.from_x.push_back(x + 0.3F), flow.from_y.push_back(y + 0.6F);
  flow.resize(flow.size());
  flow.to_x = flow.from_x, flow.to_y = flow.from_y;
  return flow;
}

class PointFlowTest : public testing::Test {
 protected:
  /// Follows from the picture to where it has moved.
  void follow(PointFlow& flow, double x, double y) {
    from.build(picture.seen(0, 0)), to.build(picture.seen(x, y));
    follow_points(from, to, settings, flow);
  }
  /// The number of points that were found, all of them within `tolerance` of where they should be.
  static int count(const PointFlow& flow, double x, double y, double tolerance) {
    int found = 0;
    for (std::size_t i = 0; i < flow.size(); ++i) {
      if (flow.found[i] == 0) continue;
      ++found;
      EXPECT_NEAR(flow.to_x[i], flow.from_x[i] + x, tolerance) << flow.from_x[i] << " " << flow.from_y[i];
      EXPECT_NEAR(flow.to_y[i], flow.from_y[i] + y, tolerance) << flow.from_x[i] << " " << flow.from_y[i];
    }
    return found;
  }

  Picture picture;
  PointFlowSettings settings{.iterations = 20, .precision = 0.01F};
  ImagePyramid from, to;
};

TEST_F(PointFlowTest, FindsPointsToAFractionOfAPixel) {
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {0.4, -0.7}, {3.3, -2.6}, {9.8, 5.1}, {-8.3, 6.5}}) {
    PointFlow flow = grid(60, 580, 60, 420);
    follow(flow, x, y);
    EXPECT_GE(count(flow, x, y, 0.35), 0.97 * static_cast<double>(flow.size())) << x << " " << y;
  }
}

TEST_F(PointFlowTest, FindsFarPointsFromWhereTheyAreExpected) {
  PointFlow flow = grid(160, 480, 160, 320);
  for (float& x : flow.to_x) x += 76.0F;
  for (float& y : flow.to_y) y -= 54.0F;
  follow(flow, 80.0, -50.0);
  EXPECT_GE(count(flow, 80.0, -50.0, 0.35), 0.97 * static_cast<double>(flow.size()));
}

TEST_F(PointFlowTest, WorksUpToTheBorderOfTheImage) {
  // A window that reaches over the border sees repeated pixels there, which can mislead it.
  PointFlow flow = grid(0, 620, 0, 460);
  follow(flow, 4.0, 3.0);
  std::size_t right = 0;
  for (std::size_t i = 0; i < flow.size(); ++i)
    right += flow.found[i] != 0 &&
                     std::hypot(flow.to_x[i] - flow.from_x[i] - 4.0F, flow.to_y[i] - flow.from_y[i] - 3.0F) < 0.7F
                 ? 1
                 : 0;
  EXPECT_GE(static_cast<double>(right), 0.95 * static_cast<double>(flow.size()));
}

TEST_F(PointFlowTest, LosesWhatLeavesTheImage) {
  PointFlow flow = grid(10, 20, 100, 300);
  for (float& x : flow.to_x) x -= 40.0F;
  follow(flow, -40.0, 0.0);
  for (const std::uint8_t found : flow.found) EXPECT_EQ(found, 0);
}

TEST_F(PointFlowTest, LosesWhatIsCovered) {
  PointFlow flow = grid(60, 580, 60, 420);
  from.build(picture.seen(0, 0));
  cv::Mat covered = picture.seen(1, 0);
  covered.colRange(0, 320).setTo(30);
  to.build(covered);
  follow_points(from, to, settings, flow);
  for (std::size_t i = 0; i < flow.size(); ++i) {
    if (flow.from_x[i] > 350.0F) {
      EXPECT_EQ(flow.found[i], 1);
    } else if (flow.found[i] != 0) {
      EXPECT_GT(flow.to_x[i], 310.0F);  // it resembles something else
    }
  }
}

TEST_F(PointFlowTest, LosesWhatHasNoTextureInTwoDirections) {
  cv::Mat edge(480, 640, CV_8UC1, cv::Scalar(50));
  edge.colRange(320, 640).setTo(200);
  from.build(edge), to.build(edge);
  PointFlow flow = grid(60, 580, 60, 420);
  follow_points(from, to, settings, flow);
  for (const std::uint8_t found : flow.found) EXPECT_EQ(found, 0);
}

TEST_F(PointFlowTest, WhatCannotBeAPositionIsNotFound) {
  PointFlow flow = grid(100, 500, 100, 100);
  constexpr float infinity = std::numeric_limits<float>::infinity();
  flow.from_x[0] = infinity, flow.to_x[1] = -infinity, flow.to_y[2] = std::nanf("");
  flow.from_x[3] = -1e9F, flow.to_y[4] = 1e30F, flow.from_y[5] = 1e9F;
  follow(flow, 1.0, 1.0);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(flow.found[i], 0) << i;
  for (std::size_t i = 6; i < flow.size(); ++i) EXPECT_EQ(flow.found[i], 1) << i;
}

TEST_F(PointFlowTest, ImagesWithoutALevelHaveNoPoints) {
  const cv::Mat pixel(1, 1, CV_8UC1, cv::Scalar(9));
  from.build(pixel), to.build(pixel);
  PointFlow flow = grid(0, 0, 0, 0);
  follow_points(from, to, settings, flow);
  EXPECT_EQ(flow.found[0], 0);
}

TEST_F(PointFlowTest, HasTheSameBitsOnEveryProcessor) {
  PointFlow first = grid(0, 620, 0, 460);
  from.build(picture.seen(0, 0)), to.build(picture.seen(5.3, -3.1));
  follow_points(from, to, settings, first, SimdLevel::scalar);
  for (const SimdLevel level : simd_levels) {
    if (!has_simd_level(level)) break;
    PointFlow flow = grid(0, 620, 0, 460);
    follow_points(from, to, settings, flow, level);
    EXPECT_EQ(flow.found, first.found) << to_string(level);
    EXPECT_EQ(std::memcmp(flow.to_x.data(), first.to_x.data(), first.size() * sizeof(float)), 0) << to_string(level);
    EXPECT_EQ(std::memcmp(flow.to_y.data(), first.to_y.data(), first.size() * sizeof(float)), 0) << to_string(level);
  }
}

}  // namespace
}  // namespace holdfast
