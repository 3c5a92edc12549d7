// SPDX-License-Identifier: BSD-3-Clause
#include "map_motion.hpp"

#include "holdfast/geometry/se3.hpp"

namespace holdfast {

MapMotion::MapMotion(const Map& map, std::span<const KeyFrameId> keyframes, std::span<const Eigen::Isometry3d> poses)
    : motion_(map.keyframes().slot_count(), Eigen::Isometry3d::Identity()) {
  std::vector<const Eigen::Isometry3d*> given(motion_.size(), nullptr);
  for (std::size_t i = 0; i < keyframes.size(); ++i)
    if (map.find_keyframe(keyframes[i]) != nullptr) given[keyframes[i].slot] = &poses[i];

  // Parents are older than their children, so their motion is known when the children's turn comes.
  Eigen::Isometry3d before = Eigen::Isometry3d::Identity();
  for (const KeyFrameId id : map.keyframes_by_age()) {
    const KeyFrame& keyframe = map.keyframe(id);
    const Eigen::Isometry3d& old_pose = keyframe.frame.T_camera_world;
    Eigen::Isometry3d& motion = motion_[id.slot];
    if (given[id.slot] != nullptr) {
      poses_.push_back({id, *given[id.slot], false});
      motion = geometry::orthonormalised(given[id.slot]->inverse() * old_pose);
    } else {
      motion = keyframe.parent.valid() ? motion_[keyframe.parent.slot] : before;
      poses_.push_back({id, geometry::orthonormalised(old_pose * motion.inverse()), true});
    }
    before = motion;
  }
}

int MapMotion::move_keyframes(Map& map) const {
  int carried = 0;
  for (const Pose& pose : poses_) {
    map.keyframe(pose.keyframe).frame.T_camera_world = pose.T_camera_world;
    carried += pose.carried ? 1 : 0;
  }
  return carried;
}

void MapMotion::move_point(MapPoint& point) const {
  const Eigen::Isometry3d& motion = around(point.reference_keyframe);
  point.position = motion * point.position;
  point.viewing_direction = motion.linear() * point.viewing_direction;
}

}  // namespace holdfast
