// SPDX-License-Identifier: BSD-3-Clause
#include "trajectory_correction.hpp"

#include "holdfast/evaluation/number_text.hpp"

namespace holdfast {

std::string TrajectoryCorrection::text() const {
  std::string text;
  const auto add = [&](const std::string& word) { text += (text.empty() ? "" : ", ") + word; };
  if (metres_per_unit != 1.0) add("multiplied by " + shortest_text(metres_per_unit));
  if (mirrored_axis) add(std::string("mirrored along ") + "xyz"[*mirrored_axis]);
  if (is_inverted) add("inverted");
  return text;
}

Trajectory corrected(const TrajectoryCorrection& correction, Trajectory trajectory) {
  for (TimedPose& pose : trajectory) {
    Eigen::Isometry3d& motion = pose.T_world_camera;
    motion.translation() *= correction.metres_per_unit;
    if (correction.mirrored_axis) {
      Eigen::Vector3d signs = Eigen::Vector3d::Ones();
      signs[*correction.mirrored_axis] = -1.0;
      const Eigen::Matrix3d rotation = signs.asDiagonal() * motion.linear() * signs.asDiagonal();
      motion.linear() = rotation;
      motion.translation() = signs.cwiseProduct(motion.translation()).eval();
    }
    if (correction.is_inverted) motion = Eigen::Isometry3d(motion.inverse());
  }
  return trajectory;
}

}  // namespace holdfast
