// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/image_depth.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "holdfast/geometry/se3.hpp"
#include "support/box_world.hpp"

namespace holdfast {
namespace {

/// A wall and a floor, of which colour and depth are exposed at different times.
class ImageDepthTest : public testing::TestWithParam<std::string> {
 protected:
  ImageDepthTest() {
    world_.camera = find_camera(GetParam()).value();
    world_.floor_y = 1.0;
  }

  SensorFrame depth_image(const Eigen::Isometry3d& T_world_camera) const {
    SensorFrame image;
    image.depth.create(world_.camera.height, world_.camera.width, CV_32FC1);
    for (int y = 0; y < world_.camera.height; ++y)
      for (int x = 0; x < world_.camera.width; ++x) {
        const Eigen::Vector2d pixel = world_.camera.undistort({x, y});
        image.depth.at<float>(y, x) = static_cast<float>(world_.look(T_world_camera, pixel.x(), pixel.y()).depth);
      }
    return image;
  }
  Frame frame() const {
    Frame frame;
    frame.camera = std::make_shared<const Camera>(world_.camera);
    std::vector<Eigen::Vector2d> raw;
    for (int y = 40; y < world_.camera.height - 40; y += 20)
      for (int x = 40; x < world_.camera.width - 40; x += 20) raw.emplace_back(x, y);
    frame.features.resize(raw.size());
    for (std::size_t i = 0; i < raw.size(); ++i) {
      frame.features.x[i] = static_cast<float>(raw[i].x());
      frame.features.y[i] = static_cast<float>(raw[i].y());
      const Eigen::Vector2d pixel = world_.camera.undistort(raw[i]);
      frame.x.push_back(static_cast<float>(pixel.x()));
      frame.y.push_back(static_cast<float>(pixel.y()));
    }
    return frame;
  }
  /// Root mean square of the depth error against the view from the identity [m].
  double error(const Frame& frame) const {
    double sum = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < frame.size(); ++i) {
      if (!frame.has_depth(i)) continue;
      const double truth = world_.look(Eigen::Isometry3d::Identity(), frame.x[i], frame.y[i]).depth;
      sum += (frame.depth[i] - truth) * (frame.depth[i] - truth);
      ++count;
    }
    EXPECT_GT(count, 300);
    return std::sqrt(sum / count);
  }

  test::BoxWorld world_;
};

TEST_P(ImageDepthTest, AlignsDepthThatWasExposedLater) {
  // 15 ms of a hand-held camera in fast rotation: 2 rad/s and 0.3 m/s.
  geometry::Vector6d motion;
  motion << 0.002, 0.001, 0.004, 0.025, -0.01, 0.01;
  const Eigen::Isometry3d T_depth_colour = geometry::exp_se3(motion);
  const SensorFrame depth = depth_image(T_depth_colour.inverse());
  ImageDepth reader(world_.camera, 0.0);
  Frame frame = this->frame();
  reader.read(depth, frame);
  const double before = error(frame);
  reader.align(depth, T_depth_colour, frame);
  const double once = error(frame);
  reader.align(depth, T_depth_colour, frame);
  EXPECT_GT(before, 0.02);
  EXPECT_LT(once, 0.15 * before);
  EXPECT_LT(error(frame), 0.1 * before);
  for (std::size_t i = 0; i < frame.size(); ++i)
    if (frame.has_depth(i)) {
      ASSERT_NEAR(frame.right_x[i], world_.camera.right_x(frame.x[i], frame.depth[i]), 1e-3);
    }
}

TEST_P(ImageDepthTest, WithoutMotionAlignmentChangesNothing) {
  const SensorFrame depth = depth_image(Eigen::Isometry3d::Identity());
  ImageDepth reader(world_.camera, 0.0);
  Frame frame = this->frame();
  reader.read(depth, frame);
  const std::vector<float> before = frame.depth;
  reader.align(depth, Eigen::Isometry3d::Identity(), frame);
  for (std::size_t i = 0; i < frame.size(); ++i) ASSERT_NEAR(frame.depth[i], before[i], 1e-5);
}

TEST_P(ImageDepthTest, AFeatureOutsideTheDepthImageHasNoDepth) {
  const SensorFrame depth = depth_image(Eigen::Isometry3d::Identity());
  ImageDepth reader(world_.camera, 0.0);
  Frame frame = this->frame();
  reader.read(depth, frame);
  Eigen::Isometry3d T_depth_colour = Eigen::Isometry3d::Identity();
  T_depth_colour.linear() = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()).toRotationMatrix();
  reader.align(depth, T_depth_colour, frame);
  int lost = 0;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const bool right = frame.x[i] > 560.0F;  // 0.3 rad are about 155 px
    if (!right) continue;
    EXPECT_FALSE(frame.has_depth(i)) << frame.x[i];
    EXPECT_TRUE(std::isnan(frame.right_x[i]));
    ++lost;
  }
  EXPECT_GT(lost, 10);
}

INSTANTIATE_TEST_SUITE_P(Cameras, ImageDepthTest, testing::Values("tum_fr1", "tum_fr3"));

}  // namespace
}  // namespace holdfast
