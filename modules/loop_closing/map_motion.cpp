// SPDX-License-Identifier: BSD-3-Clause
#include "map_motion.hpp"

#include "holdfast/geometry/se3.hpp"
#include "holdfast/interfaces/frame_observations.hpp"

namespace holdfast {

MapMotion::MapMotion(const Map& map, std::span<const KeyFrameId> keyframes, std::span<const Eigen::Isometry3d> poses,
                     std::span<const double> scales, std::span<const std::uint8_t> is_weak)
    : motion_(map.keyframes().slot_count(), Eigen::Isometry3d::Identity()), scale_(motion_.size(), 1.0) {
  std::vector<const Eigen::Isometry3d*> given(motion_.size(), nullptr);
  std::vector<std::uint8_t> is_weakly_constrained(motion_.size(), 0);
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    if (map.find_keyframe(keyframes[i]) == nullptr) continue;
    given[keyframes[i].slot] = &poses[i];
    if (!scales.empty()) scale_[keyframes[i].slot] = scales[i];
    if (!is_weak.empty()) is_weakly_constrained[keyframes[i].slot] = is_weak[i];
  }

  // Parents are older than their children, so their motion is computed before.
  Eigen::Isometry3d before = Eigen::Isometry3d::Identity();
  double scale_before = 1.0;
  for (const KeyFrameId id : map.keyframes_by_age()) {
    const KeyFrame& keyframe = map.keyframe(id);
    const Eigen::Isometry3d& old_pose = keyframe.frame.T_camera_world;
    Eigen::Isometry3d& motion = motion_[id.slot];
    double& scale = scale_[id.slot];
    // With a scale, new camera = scale * old camera for every point; a pose keeps its rotation and unit of length.
    const auto scaled_pose = [&old_pose](double factor) {
      Eigen::Isometry3d scaled = old_pose;
      scaled.translation() *= factor;
      return scaled;
    };
    const Eigen::Isometry3d& with_parent = keyframe.parent.valid() ? motion_[keyframe.parent.slot] : before;
    const double scale_of_parent = keyframe.parent.valid() ? scale_[keyframe.parent.slot] : scale_before;
    const bool has_diverged = given[id.slot] != nullptr && is_weakly_constrained[id.slot] != 0 &&
                              keyframe.parent.valid() &&
                              geometry::exceeds(*given[id.slot] * with_parent * scaled_pose(scale_of_parent).inverse(),
                                                divergence_from_parent, divergence_from_parent);
    if (given[id.slot] != nullptr && !has_diverged) {
      poses_.push_back({id, *given[id.slot], false, scale});
      motion = geometry::orthonormalised(given[id.slot]->inverse() * scaled_pose(scale));
    } else {
      motion = with_parent;
      scale = scale_of_parent;
      poses_.push_back({id, geometry::orthonormalised(scaled_pose(scale) * motion.inverse()), true, scale});
    }
    before = motion;
    scale_before = scale;
  }
}

int MapMotion::move_keyframes(Map& map) const {
  int carried = 0;
  for (const Pose& pose : poses_) {
    KeyFrame& keyframe = map.keyframe(pose.keyframe);
    if (keyframe.motion)
      keyframe.motion->velocity = pose.scale * (pose.T_camera_world.linear().transpose() *
                                                (keyframe.frame.T_camera_world.linear() * keyframe.motion->velocity));
    keyframe.frame.T_camera_world = pose.T_camera_world;
    keyframe.scale *= pose.scale;
    carried += pose.carried ? 1 : 0;
  }
  return carried;
}

void MapMotion::move_point(MapPoint& point) const {
  const Eigen::Isometry3d& motion = motion_[point.reference_keyframe.slot];
  point.position = motion * (scale_[point.reference_keyframe.slot] * point.position);
  point.viewing_direction = motion.linear() * point.viewing_direction;
}

}  // namespace holdfast
