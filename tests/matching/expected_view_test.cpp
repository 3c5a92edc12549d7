// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/matching/expected_view.hpp"

#include <gtest/gtest.h>

#include "holdfast/matching/frame_features.hpp"
#include "holdfast/matching/point_block.hpp"
#include "matching/grid_frame.hpp"

namespace holdfast {
namespace {

/// A point in front of a camera at the identity, seen along the optical axis from 2 m.
MapPoint point_at(const Eigen::Vector3d& position) {
  MapPoint point;
  point.position = position;
  point.viewing_direction = Eigen::Vector3d::UnitZ();
  point.minimum_distance = 1.0F;
  point.maximum_distance = 4.0F;
  return point;
}

class ExpectedView : public testing::Test {
 protected:
  std::optional<matching::ExpectedView> expect(const MapPoint& point) const {
    return projection_into(frame, T_camera_world)
        .expect(point.position.cast<float>(), point.viewing_direction.cast<float>(), point.minimum_distance,
                point.maximum_distance);
  }
  Frame frame = test::grid_frame(1);
  Eigen::Isometry3d T_camera_world = Eigen::Isometry3d::Identity();
};

TEST_F(ExpectedView, IsWhereTheCameraProjectsThePoint) {
  T_camera_world = Eigen::Translation3d(0.1, -0.2, 0.3) * Eigen::AngleAxisd(0.2, Eigen::Vector3d(1, 2, 3).normalized());
  const MapPoint point = point_at({0.2, 0.1, 2.0});
  const Eigen::Vector3d in_camera = T_camera_world * point.position;
  const Eigen::Vector2d pixel = frame.camera->project(in_camera);
  const auto view = expect(point);
  ASSERT_TRUE(view);
  EXPECT_NEAR(view->pixel.x, pixel.x(), 1e-3);
  EXPECT_NEAR(view->pixel.y, pixel.y(), 1e-3);
  EXPECT_NEAR(view->pixel.right_x, frame.camera->right_x(pixel.x(), in_camera.z()), 1e-3);
  EXPECT_NEAR(view->distance, in_camera.norm(), 1e-6);
  EXPECT_NEAR(view->cosine, in_camera.normalized().dot(T_camera_world.linear() * point.viewing_direction), 1e-6);
}

TEST_F(ExpectedView, RefusesPointsBehindTheCameraOrTooNear) {
  MapPoint point = point_at({0, 0, -2});
  EXPECT_FALSE(expect(point));
  point = point_at({0, 0, 0.06});
  point.minimum_distance = 0.01F;
  EXPECT_TRUE(expect(point));
  point.position.z() = 0.04;
  EXPECT_FALSE(expect(point));
}

TEST_F(ExpectedView, RefusesPointsOutsideTheImage) {
  EXPECT_TRUE(expect(point_at(frame.camera->back_project(638, 478, 2))));
  EXPECT_FALSE(expect(point_at(frame.camera->back_project(641, 240, 2))));
  EXPECT_FALSE(expect(point_at(frame.camera->back_project(320, -2, 2))));
}

TEST_F(ExpectedView, RefusesDistancesFromWhichTheDescriptorIsNotRecognised) {
  EXPECT_TRUE(expect(point_at({0, 0, 0.81})));
  EXPECT_FALSE(expect(point_at({0, 0, 0.79})));
  EXPECT_TRUE(expect(point_at({0, 0, 4.79})));
  EXPECT_FALSE(expect(point_at({0, 0, 4.81})));
}

TEST_F(ExpectedView, RefusesViewsFarOffTheMeanViewingDirection) {
  MapPoint point = point_at({0, 0, 2});
  point.viewing_direction = Eigen::AngleAxisd(1.04, Eigen::Vector3d::UnitY()) * Eigen::Vector3d::UnitZ();
  EXPECT_TRUE(expect(point));
  point.viewing_direction = Eigen::AngleAxisd(1.06, Eigen::Vector3d::UnitY()) * Eigen::Vector3d::UnitZ();
  EXPECT_FALSE(expect(point));
}

TEST_F(ExpectedView, WindowsFollowScaleAngleAndSettings) {
  PointBlock points;
  points.add({}, point_at({0, 0, 2}));       // frontal; expected at octave ceil(log(4 / 2) / log(1.2)) = 4
  points.add({}, point_at({0.5, 0, 2}));     // 14 degrees off
  points.add({}, point_at({0, 0, -1}));      // not expected
  points.add({}, point_at({0, 0.01, 2.0}));  // expected, not wanted
  matching::SearchWindows windows;
  const matching::WindowSettings settings{
      .radius = 4.0F, .frontal_radius = 2.5F, .factor = 2.0F, .finer_octaves = 1, .coarser_octaves = 2};
  std::vector<std::uint32_t> asked;
  const auto is_wanted = [&](std::uint32_t i) {
    asked.push_back(i);
    return i != 3;
  };
  const int expected =
      matching::add_windows(frame, projection_into(frame, T_camera_world), points, settings, is_wanted, windows);
  EXPECT_EQ(expected, 3);
  EXPECT_EQ(asked, (std::vector<std::uint32_t>{0, 1, 3}));
  ASSERT_EQ(windows.source, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_FLOAT_EQ(windows.radius[0], 5.0F * frame.pyramid->scale[4]);
  EXPECT_FLOAT_EQ(windows.radius[1], 8.0F * frame.pyramid->scale[4]);
  EXPECT_EQ(windows.min_octave[0], 3);
  EXPECT_EQ(windows.max_octave[0], 6);
}

}  // namespace
}  // namespace holdfast
