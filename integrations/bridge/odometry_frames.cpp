// SPDX-License-Identifier: BSD-3-Clause
#include "odometry_frames.hpp"

#include "holdfast/geometry/so3.hpp"

namespace holdfast::bridge {

void OdometryFrames::add(const Eigen::Isometry3d& T_map_base, const std::optional<Eigen::Isometry3d>& motion) {
  // The odometry begins where the map does; in a map of a file, where the robot is found.
  if (is_first_)
    T_odom_base_ = T_map_base;
  else if (motion)
    T_odom_base_ = T_odom_base_ * *motion;
  // Rounding errors of a long drive.
  T_odom_base_.linear() = Eigen::Quaterniond(T_odom_base_.linear()).normalized().toRotationMatrix();
  T_map_odom_ = is_first_ ? Eigen::Isometry3d::Identity() : T_map_base * T_odom_base_.inverse();
  is_first_ = false;
}

void OdometryFrames::add_with_odometry(const Eigen::Isometry3d& T_map_base, const Eigen::Isometry3d& T_odom_base) {
  T_odom_base_ = T_odom_base;
  T_map_odom_ = T_map_base * T_odom_base.inverse();
  is_first_ = false;
}

Eigen::Matrix<double, 6, 6> covariance_in_map(const Eigen::Matrix<double, 6, 6>& covariance,
                                              const Eigen::Isometry3d& T_map_base,
                                              const Eigen::Isometry3d& T_base_camera) {
  // exp(d) after the camera moves the base's origin, which is off the camera's by `arm`.
  const Eigen::Isometry3d T_map_camera = T_map_base * T_base_camera;
  const Eigen::Matrix3d R_map_camera = T_map_camera.linear();
  const Eigen::Vector3d arm = T_map_base.translation() - T_map_camera.translation();
  Eigen::Matrix<double, 6, 6> J = Eigen::Matrix<double, 6, 6>::Zero();
  J.topLeftCorner<3, 3>() = R_map_camera;
  J.topRightCorner<3, 3>() = -geometry::hat(arm) * R_map_camera;
  J.bottomRightCorner<3, 3>() = R_map_camera;
  return J * covariance * J.transpose();
}

Eigen::Matrix<double, 6, 1> velocity_of(const Eigen::Isometry3d& motion, double seconds) {
  Eigen::Matrix<double, 6, 1> velocity = Eigen::Matrix<double, 6, 1>::Zero();
  if (!(seconds > 0.0)) return velocity;
  const Eigen::AngleAxisd rotation(motion.linear());
  velocity << motion.translation() / seconds, rotation.angle() / seconds * rotation.axis();
  return velocity;
}

}  // namespace holdfast::bridge
