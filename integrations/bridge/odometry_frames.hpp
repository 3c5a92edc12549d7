// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <optional>

namespace holdfast::bridge {

/// The transforms of REP 105 from poses in a map: `odom` to `base` is continuous and drifts, `map` to `odom` takes the
/// corrections of the map and the jumps after a loss. One thread.
class OdometryFrames {
 public:
  /// A pose of the robot. `motion`: T_previous_now since the last pose, as the map sees both now, so that corrections
  /// are not part of it; nothing after a loss or in a new map, where the odometry stands still.
  void add(const Eigen::Isometry3d& T_map_base, const std::optional<Eigen::Isometry3d>& motion);
  /// A pose of the robot in the odometry of somebody else.
  void add_with_odometry(const Eigen::Isometry3d& T_map_base, const Eigen::Isometry3d& T_odom_base);

  const Eigen::Isometry3d& T_map_odom() const { return T_map_odom_; }
  const Eigen::Isometry3d& T_odom_base() const { return T_odom_base_; }

 private:
  bool is_first_ = true;
  Eigen::Isometry3d T_map_odom_ = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_odom_base_ = Eigen::Isometry3d::Identity();
};

/// Covariance of a pose T_map_base in the form of geometry_msgs/PoseWithCovariance (translation in `map`, rotation
/// about its fixed axes), of that of T_map_camera * exp(d) with d in the camera frame
/// (FrameResult::covariance).
Eigen::Matrix<double, 6, 6> covariance_in_map(const Eigen::Matrix<double, 6, 6>& covariance,
                                              const Eigen::Isometry3d& T_map_base,
                                              const Eigen::Isometry3d& T_base_camera);

/// Linear and angular velocity of a motion T_previous_now in `seconds`, in the moving frame.
Eigen::Matrix<double, 6, 1> velocity_of(const Eigen::Isometry3d& motion, double seconds);

}  // namespace holdfast::bridge
