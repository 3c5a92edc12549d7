// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/moving_world/point_follower.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "../support/picture.hpp"

namespace holdfast {
namespace {

class PointFollowerTest : public testing::Test {
 protected:
  Frame frame_with_depth(float depth, const Camera& camera = {}) {
    Frame frame;
    frame.camera = std::make_shared<Camera>(camera);
    frame.coarse.grid = CoarseSampler(camera).grid();
    frame.coarse.depth.assign(static_cast<std::size_t>(frame.coarse.grid.size()), depth);
    return frame;
  }
  /// Points over the middle of the image, at the strongest corner of each square of 40 px.
  void add_points(const Frame& frame) {
    for (int y = 100; y < 380; y += 40)
      for (int x = 100; x < 540; x += 40) {
        cv::Point best(x, y);
        for (int dy = 0; dy < 40; dy += 2)
          for (int dx = 0; dx < 40; dx += 2)
            if (follower.corner_strength(x + dx, y + dy) > follower.corner_strength(best.x, best.y))
              best = {x + dx, y + dy};
        follower.add(frame, static_cast<float>(best.x), static_cast<float>(best.y), 4);
      }
  }
  /// Distance of the points from where they were plus a shift that 19 of 20 do not exceed.
  double error(const PointFollower::Points& before, double shift_x, double shift_y) const {
    const PointFollower::Points& now = follower.points();
    std::vector<double> errors;
    for (std::size_t i = 0, j = 0; i < now.size(); ++i) {
      while (before.id[j] != now.id[i]) ++j;
      errors.push_back(std::hypot(now.raw_x[i] - before.raw_x[j] - shift_x, now.raw_y[i] - before.raw_y[j] - shift_y));
    }
    std::sort(errors.begin(), errors.end());
    return errors[errors.size() * 19 / 20];
  }

  Picture picture;
  PointFollower follower;
};

TEST_F(PointFollowerTest, FollowsToAFractionOfAPixel) {
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {0.4, -0.7}, {3.3, -2.6}, {17.8, 9.1}, {-18.3, 12.5}}) {
    follower = {};
    const Frame frame = frame_with_depth(2.0F);
    follower.advance(picture.seen(0, 0), frame);
    add_points(frame);
    const PointFollower::Points before = follower.points();
    ASSERT_EQ(before.size(), 77U);
    follower.advance(picture.seen(x, y), frame);
    EXPECT_GE(follower.points().size(), 70U) << x << " " << y;
    EXPECT_LE(error(before, x, y), 0.15) << x << " " << y;
  }
}

TEST_F(PointFollowerTest, ExpectsAMotionToGoOn) {
  // Faster and faster, to more than the pyramid reaches from where a point was.
  const Frame frame = frame_with_depth(2.0F);
  follower.advance(picture.seen(-80, 0), frame);
  add_points(frame);
  const PointFollower::Points before = follower.points();
  double at = 0.0, step = 0.0;
  while (step < 48.0) {
    step += 16.0;
    at += step;
    follower.advance(picture.seen(at - 80, 0), frame);
  }
  EXPECT_GE(follower.points().size(), 60U);
  EXPECT_LE(error(before, at, 0.0), 0.3);
}

TEST_F(PointFollowerTest, IdsRiseAndTheRestStaysWithItsPoint) {
  const Frame frame = frame_with_depth(2.0F);
  follower.advance(picture.seen(0, 0), frame);
  add_points(frame);
  follower.label(10) = 9;
  const std::uint64_t tenth = follower.points().id[10], last = follower.points().id.back();
  follower.filter([&](std::size_t i) { return i % 5 == 0; });
  ASSERT_EQ(follower.points().size(), 16U);
  follower.add(frame, 300.0F, 200.0F, 1);
  const PointFollower::Points& points = follower.points();
  EXPECT_GT(points.id.back(), last);
  EXPECT_TRUE(std::is_sorted(points.id.begin(), points.id.end()));
  for (std::size_t i = 0; i + 1 < points.size(); ++i) EXPECT_EQ(points.label[i], points.id[i] == tenth ? 9 : 4);
  EXPECT_EQ(points.label.back(), 1);
  const PointFollower::Points before = points;
  follower.advance(picture.seen(5, 3), frame);
  EXPECT_LE(error(before, 5, 3), 0.15);
}

TEST_F(PointFollowerTest, WhatLeavesTheImageIsLost) {
  const Frame frame = frame_with_depth(2.0F);
  follower.advance(picture.seen(0, 0), frame);
  for (float y = 40.0F; y < 440.0F; y += 20.0F) follower.add(frame, 15.0F, y, 0);
  follower.add(frame, 300.0F, 200.0F, 1);
  follower.advance(picture.seen(-25, 0), frame);
  // One that left may resemble what is seen inside; where it is expected outside, it is lost.
  EXPECT_LE(follower.points().size(), 5U);
  follower.advance(picture.seen(-50, 0), frame);
  EXPECT_LE(follower.points().size(), 3U);
  EXPECT_EQ(follower.points().label.back(), 1);
}

TEST_F(PointFollowerTest, WhatCannotBeSeenAnyMoreIsLost) {
  const Frame frame = frame_with_depth(2.0F);
  follower.advance(picture.seen(0, 0), frame);
  add_points(frame);
  cv::Mat covered = picture.seen(0, 0);
  covered.colRange(0, 320).setTo(0);
  follower.advance(covered, frame);
  int left = 0;
  for (const float x : follower.points().raw_x) left += x < 300.0F ? 1 : 0;
  EXPECT_EQ(left, 0);
  EXPECT_GE(follower.points().size(), 25U);
}

TEST_F(PointFollowerTest, APointThatJumpsInDepthSlidOffItsObject) {
  Frame frame = frame_with_depth(2.0F);
  follower.advance(picture.seen(0, 0), frame);
  add_points(frame);
  Frame next = frame_with_depth(2.1F);
  follower.advance(picture.seen(1, 0), next);
  const std::size_t kept = follower.points().size();
  EXPECT_GE(kept, 70U);
  EXPECT_EQ(follower.points().depth[0], 2.1F);
  next = frame_with_depth(0.0F);  // unknown: nothing is learnt
  follower.advance(picture.seen(2, 0), next);
  EXPECT_EQ(follower.points().size(), kept);
  EXPECT_EQ(follower.points().depth[0], 2.1F);
  next = frame_with_depth(3.5F);
  follower.advance(picture.seen(3, 0), next);
  EXPECT_EQ(follower.points().size(), 0U);
}

TEST_F(PointFollowerTest, PositionsAreUndistorted) {
  const Camera camera = find_camera("tum_fr1").value();
  const Frame frame = frame_with_depth(2.0F, camera);
  follower.advance(picture.seen(0, 0), frame);
  follower.add(frame, 60.0F, 50.0F, 0);
  for (int i = 0; i < 2; ++i) {
    const PointFollower::Points& points = follower.points();
    ASSERT_EQ(points.size(), 1U);
    const Eigen::Vector2d pixel = camera.undistort({points.raw_x[0], points.raw_y[0]});
    EXPECT_GT((pixel - Eigen::Vector2d(points.raw_x[0], points.raw_y[0])).norm(), 1.0);
    EXPECT_NEAR(points.x[0], pixel.x(), 1e-3);
    EXPECT_NEAR(points.y[0], pixel.y(), 1e-3);
    follower.advance(picture.seen(6, 4), frame);
  }
}

TEST_F(PointFollowerTest, CornersAreStrongAndEdgesAreNot) {
  cv::Mat image(480, 640, CV_8UC1, cv::Scalar(50));
  image(cv::Rect(200, 100, 200, 200)).setTo(220);
  follower.advance(image, frame_with_depth(2.0F));
  EXPECT_GT(follower.corner_strength(200, 100), 200);
  EXPECT_LT(follower.corner_strength(200, 200), 50);
  EXPECT_EQ(follower.corner_strength(100, 400), 0);
  EXPECT_EQ(follower.corner_strength(10000, 10), 0);
  EXPECT_EQ(follower.corner_strength(10, 10000), 0);
}

}  // namespace
}  // namespace holdfast
