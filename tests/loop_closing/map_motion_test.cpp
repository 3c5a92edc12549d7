// SPDX-License-Identifier: BSD-3-Clause
#include "map_motion.hpp"

#include <gtest/gtest.h>

#include <array>

namespace holdfast {
namespace {

Eigen::Isometry3d pose(double x, double y, double z, double angle) {
  return Eigen::Translation3d(x, y, z) * Eigen::AngleAxisd(angle, Eigen::Vector3d(1, 2, -1).normalized());
}

/// A row of keyframes, each of which shows points in front of it, and all of which show a common one, so that each but
/// the first has a parent.
class MapMotionTest : public testing::Test {
 protected:
  static constexpr std::uint32_t points_per_keyframe = 4;

  MapMotionTest() {
    const auto camera = std::make_shared<const Camera>();
    const auto pyramid = std::make_shared<const ScalePyramid>();
    for (int k = 0; k < 4; ++k) {
      Frame frame;
      frame.camera = camera, frame.pyramid = pyramid;
      frame.timestamp = k;
      frame.features.resize(points_per_keyframe + 1);
      frame.x.assign(points_per_keyframe + 1, 320.0F), frame.y.assign(points_per_keyframe + 1, 240.0F);
      frame.depth.assign(points_per_keyframe + 1, 0.0F), frame.right_x.assign(points_per_keyframe + 1, 0.0F);
      frame.static_probability.assign(points_per_keyframe + 1, 1.0F);
      frame.measured_log_odds.assign(points_per_keyframe + 1, 0.0F);
      frame.map_points.assign(points_per_keyframe + 1, MapPointId());
      frame.T_camera_world = pose(0.4 * k, -0.1 * k, 0.2, 0.1 * k);
      ids_.push_back(map_.add_keyframe(std::move(frame)));
      for (std::uint32_t f = 0; f < points_per_keyframe; ++f) {
        const Eigen::Vector3d in_camera(0.3 * f - 0.5, 0.2 * f, 2.0 + 0.3 * f);
        const Eigen::Isometry3d T_world_camera = map_.keyframe(ids_.back()).frame.T_world_camera();
        const MapPointId point = map_.add_point(T_world_camera * in_camera, map_.keyframe(ids_.back()).sequence);
        map_.add_observation(point, ids_.back(), f);
        map_.update_point(point);
      }
      if (!common_.valid()) common_ = map_.add_point({0, 0, 3}, 0);
      map_.add_observation(common_, ids_.back(), points_per_keyframe);
      map_.update_point(common_);
      map_.set_covisibility_minimum(1);
      map_.update_covisibility(ids_.back());
    }
  }

  /// Where the keyframe's points are seen by it.
  std::vector<Eigen::Vector3d> seen(int k) const {
    const Frame& frame = map_.keyframe(ids_[static_cast<std::size_t>(k)]).frame;
    std::vector<Eigen::Vector3d> points;
    for (std::uint32_t f = 0; f < points_per_keyframe; ++f)
      points.push_back(frame.T_camera_world * map_.point(frame.map_points[f]).position);
    return points;
  }
  void apply(const MapMotion& motion) {
    motion.move_keyframes(map_);
    for (const MapPointId id : map_.points().ids()) motion.move_point(map_.point(id));
  }

  Map map_;
  std::vector<KeyFrameId> ids_;
  MapPointId common_;
};

TEST_F(MapMotionTest, AVelocityTurnsWithItsKeyframe) {
  const Eigen::Vector3d velocity(0.3, -0.2, 0.5);
  for (const KeyFrameId id : ids_) map_.keyframe(id).motion = KeyFrameMotion{velocity, {}};
  const std::vector<Eigen::Isometry3d> before = {map_.pose_of(ids_[0]), map_.pose_of(ids_[1]), map_.pose_of(ids_[2])};
  const std::array<Eigen::Isometry3d, 2> poses = {pose(1, 2, 3, 0.4), pose(-1, 0, 2, -0.3)};
  apply(MapMotion(map_, std::span(ids_).first(2), poses));
  for (std::size_t i = 0; i < 3; ++i) {
    const KeyFrame& keyframe = map_.keyframe(ids_[i]);
    EXPECT_LT(
        (keyframe.frame.T_camera_world.linear() * keyframe.motion->velocity - before[i].linear() * velocity).norm(),
        1e-12)
        << i << ": as the camera sees it";
    EXPECT_GT((keyframe.motion->velocity - velocity).norm(), 0.01) << i;
  }
}

TEST_F(MapMotionTest, APointStaysWhereItsKeyframeSeesItInTheKeyframesScale) {
  std::array<std::vector<Eigen::Vector3d>, 4> before;
  for (int k = 0; k < 4; ++k) before[static_cast<std::size_t>(k)] = seen(k);
  const std::array<Eigen::Isometry3d, 4> poses = {pose(1, 2, 3, 0.4), pose(-1, 0, 2, -0.3), pose(0, 0, 0, 1.0),
                                                  pose(2, 2, -2, 0.1)};
  const std::array<double, 4> scales = {1.0, 1.2, 0.5, 2.0};
  const Eigen::Vector3d direction = map_.point(map_.keyframe(ids_[1]).frame.map_points[2]).viewing_direction;
  const Eigen::Matrix3d R_old = map_.keyframe(ids_[1]).frame.T_camera_world.linear();
  apply(MapMotion(map_, ids_, poses, scales));
  for (int k = 0; k < 4; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const KeyFrame& keyframe = map_.keyframe(ids_[i]);
    EXPECT_TRUE(keyframe.frame.T_camera_world.isApprox(poses[i], 1e-12)) << k;
    EXPECT_DOUBLE_EQ(keyframe.scale, scales[i]) << k;
    const std::vector<Eigen::Vector3d> now = seen(k);
    for (std::size_t p = 0; p < now.size(); ++p)
      EXPECT_TRUE(now[p].isApprox(scales[i] * before[i][p], 1e-9)) << "keyframe " << k << ", point " << p;
  }
  EXPECT_TRUE((poses[1].linear() * map_.point(map_.keyframe(ids_[1]).frame.map_points[2]).viewing_direction)
                  .isApprox(R_old * direction, 1e-9));
}

TEST_F(MapMotionTest, AKeyframeWithoutAPoseIsCarriedWithItsParentInItsScale) {
  const Eigen::Isometry3d& old_child = map_.keyframe(ids_[3]).frame.T_camera_world;
  const KeyFrameId parent = map_.keyframe(ids_[3]).parent;
  ASSERT_TRUE(parent.valid());
  const Eigen::Isometry3d relative = old_child * map_.keyframe(parent).frame.T_camera_world.inverse();
  const std::vector<Eigen::Vector3d> before = seen(3);
  const std::vector<KeyFrameId> given(ids_.begin(), ids_.begin() + 3);
  const std::array<Eigen::Isometry3d, 3> poses = {pose(1, 2, 3, 0.4), pose(-1, 0, 2, -0.3), pose(0, 0, 0, 1.0)};
  const std::array<double, 3> scales = {0.7, 0.7, 0.7};
  apply(MapMotion(map_, given, poses, scales));
  const Eigen::Isometry3d now =
      map_.keyframe(ids_[3]).frame.T_camera_world * map_.keyframe(parent).frame.T_camera_world.inverse();
  EXPECT_TRUE(now.translation().isApprox(0.7 * relative.translation(), 1e-9));
  EXPECT_TRUE(now.linear().isApprox(relative.linear(), 1e-9));
  EXPECT_DOUBLE_EQ(map_.keyframe(ids_[3]).scale, 0.7);
  for (std::size_t p = 0; p < before.size(); ++p) EXPECT_TRUE(seen(3)[p].isApprox(0.7 * before[p], 1e-9));
}

/// A pose that differs from that relative to the parent only by the growth of the map is kept; one that differs more is
/// rejected.
TEST_F(MapMotionTest, AWeakKeyframeIsComparedWithItsParentInTheParentsScale) {
  const std::vector<double> scales(4, 3.0);
  const std::vector<std::uint8_t> is_weak = {0, 0, 0, 1};
  std::vector<Eigen::Isometry3d> poses;
  for (const KeyFrameId id : ids_) {
    poses.push_back(map_.keyframe(id).frame.T_camera_world);
    poses.back().translation() *= 3.0;
  }
  std::vector<Eigen::Isometry3d> fled = poses;
  fled[3].translation().x() += 0.5;
  const MapMotion growth(map_, ids_, poses, scales, is_weak), flight(map_, ids_, fled, scales, is_weak);
  EXPECT_EQ(growth.move_keyframes(map_), 0);
  EXPECT_TRUE(map_.pose_of(ids_[3]).isApprox(poses[3], 1e-12));
  EXPECT_EQ(flight.move_keyframes(map_), 1);
}

TEST_F(MapMotionTest, ScalesMultiplyFromLoopToLoop) {
  std::vector<Eigen::Isometry3d> poses;
  for (const KeyFrameId id : ids_) poses.push_back(map_.keyframe(id).frame.T_camera_world);
  const std::vector<double> scales(4, 1.5);
  apply(MapMotion(map_, ids_, poses, scales));
  apply(MapMotion(map_, ids_, poses, scales));
  EXPECT_DOUBLE_EQ(map_.scale_of(ids_[2]), 2.25);
  apply(MapMotion(map_, ids_, poses));
  EXPECT_DOUBLE_EQ(map_.scale_of(ids_[2]), 2.25) << "without scales, everything is rigid";
}

}  // namespace
}  // namespace holdfast
