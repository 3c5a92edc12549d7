// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/feature_flow.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "holdfast/core/random.hpp"

namespace holdfast {
namespace {

/// A wall in front of the camera, seen from straight ahead.
class Wall {
 public:
  Wall() : texture_(960, 1280, CV_8UC1) {
    camera_.fx = camera_.fy = 500.0;
    camera_.cx = 319.5, camera_.cy = 239.5;
    Random random(5);
    for (int y = 0; y < texture_.rows; ++y)
      for (int x = 0; x < texture_.cols; ++x)
        texture_.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(random.below(256));
    cv::GaussianBlur(texture_, texture_, {0, 0}, 3.0);
    cv::normalize(texture_, texture_, 0, 255, cv::NORM_MINMAX);
  }

  /// The wall after the camera has moved to the right and down, in pixels of the wall.
  cv::Mat image(double right, double down) const {
    const cv::Mat shift = (cv::Mat_<double>(2, 3) << 1, 0, -320 - right, 0, 1, -240 - down);
    cv::Mat image;
    cv::warpAffine(texture_, image, shift, {camera_.width, camera_.height}, cv::INTER_CUBIC);
    return image;
  }
  Eigen::Isometry3d pose(double right, double down) const {
    Eigen::Isometry3d T_camera_world = Eigen::Isometry3d::Identity();
    T_camera_world.translation() = Eigen::Vector3d(-right, -down, 0.0) * depth / camera_.fx;
    return T_camera_world;
  }
  /// A frame from the start with features on a grid, all of the map and static.
  Frame frame() const {
    Frame frame;
    frame.camera = std::make_shared<const Camera>(camera_);
    for (float y = 40; y < 440; y += 40)
      for (float x = 40; x < 600; x += 40) {
        frame.features.x.push_back(x + 0.3F), frame.features.y.push_back(y + 0.6F);
        frame.map_points.push_back({static_cast<std::uint32_t>(frame.map_points.size()), 0});
      }
    const std::size_t count = frame.map_points.size();
    frame.features.resize(count, DescriptorType());
    frame.x = frame.features.x, frame.y = frame.features.y;
    frame.depth.assign(count, static_cast<float>(depth));
    frame.right_x.assign(count, 0.0F);
    frame.static_probability.assign(count, 1.0F);
    return frame;
  }

  static constexpr double depth = 2.0;  // [m]

 private:
  Camera camera_;
  cv::Mat texture_;
};

TEST(FeatureFlow, FindsTheFeaturesToAFractionOfAPixel) {
  const Wall wall;
  FeatureFlow flow;
  flow.add_image(wall.image(0, 0));
  const double right = 31.4, down = -17.8, wrong = 3.0;
  flow.add_image(wall.image(right, down));
  const Frame start = wall.frame();
  flow.set_template(start);
  ASSERT_EQ(flow.size(), start.size());
  Features found;
  ASSERT_TRUE(flow.follow(wall.pose(right + wrong, down - wrong), {}, found));
  ASSERT_EQ(found.size(), flow.found_points().size());
  EXPECT_GT(found.size(), start.size() * 8 / 10) << "but for those that leave the image";
  for (std::size_t i = 0; i < found.size(); ++i) {
    const std::size_t from = flow.found_points()[i].slot;
    EXPECT_NEAR(found.x[i], start.features.x[from] - right, 0.2) << i;
    EXPECT_NEAR(found.y[i], start.features.y[from] - down, 0.2) << i;
  }
  // The same template serves the images after it.
  flow.add_image(wall.image(2 * right, 2 * down));
  ASSERT_TRUE(flow.follow(wall.pose(2 * right, 2 * down), {}, found));
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found.x[i], start.features.x[flow.found_points()[i].slot] - 2 * right, 0.2) << i;
}

TEST(FeatureFlow, FollowsStaticPointsOfTheMapOnly) {
  const Wall wall;
  Frame start = wall.frame();
  start.map_points[3] = MapPointId();
  start.static_probability[5] = 0.2F;
  cv::Mat ignore = cv::Mat::zeros(480, 640, CV_8UC1);
  ignore(cv::Rect(0, 0, 640, 100)) = 255;
  FeatureFlow flow;
  flow.add_image(wall.image(0, 0));
  flow.add_image(wall.image(4, 2));
  flow.set_template(start);
  EXPECT_EQ(flow.size(), start.size() - 2);
  Features found;
  ASSERT_TRUE(flow.follow(wall.pose(4, 2), ignore, found));
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_NE(flow.found_points()[i].slot, 3U);
    EXPECT_NE(flow.found_points()[i].slot, 5U);
    EXPECT_GE(found.y[i], 99.0F);
  }
  flow.clear();
  EXPECT_FALSE(flow.follow(wall.pose(4, 2), {}, found));
}

TEST(FeatureFlow, FindsNothingInAnotherImage) {
  const Wall wall;
  FeatureFlow flow;
  flow.add_image(wall.image(0, 0));
  cv::Mat dark(480, 640, CV_8UC1, cv::Scalar(0));
  flow.add_image(dark);
  flow.set_template(wall.frame());
  Features found;
  EXPECT_FALSE(flow.follow(wall.pose(0, 0), {}, found));
}

}  // namespace
}  // namespace holdfast
