// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include "holdfast/geometry/inertial_state.hpp"

namespace holdfast {

namespace geometry {
class Preintegration;
}

/// Error-state Kalman filter that couples poses from images loosely with inertial measurements: preintegrated motions
/// (Forster et al. 2017, equations 45 and 47) propagate the state of the body and gravity, poses correct them.
///
/// Its error has 18 components: the 15 of geometry::InertialState in the order of geometry::inertial, then gravity
/// [m/s^2] in the world frame, whose magnitude is known. A value type.
class InertialFilter {
 public:
  using Covariance = Eigen::Matrix<double, 18, 18>;
  /// Of the error of a pose: position [m] in the world frame, rotation [rad] in the body frame.
  using PoseCovariance = Eigen::Matrix<double, 6, 6>;

  /// Standard deviations of the first state, per axis, without correlations.
  struct Deviations {
    double position = 0.0;       ///< [m]
    double rotation = 0.0;       ///< [rad]
    double velocity = 0.0;       ///< [m/s]
    double gyroscope = 0.0;      ///< bias [rad/s]
    double accelerometer = 0.0;  ///< bias [m/s^2]
    double direction = 0.0;      ///< of gravity [rad]
  };

  InertialFilter(const geometry::InertialState& state, const Eigen::Vector3d& gravity, const Deviations& deviations);

  /// Propagates the state by the measurements that follow it.
  void predict(const geometry::Preintegration& motion);
  /// Squared Mahalanobis distance of a measured pose T_world_body from the state, with six degrees of freedom.
  double chi_square(const Eigen::Isometry3d& measured, const PoseCovariance& covariance) const;
  /// Corrects the state by a measured pose T_world_body.
  void correct(const Eigen::Isometry3d& measured, const PoseCovariance& covariance);
  /// Expresses the state in another world frame, or in one that a correction of the map moved.
  void move(const Eigen::Isometry3d& T_new_old);

  const geometry::InertialState& state() const { return state_; }
  const Eigen::Vector3d& gravity() const { return gravity_; }
  const Covariance& covariance() const { return covariance_; }
  PoseCovariance pose_covariance() const { return covariance_.topLeftCorner<6, 6>(); }

 private:
  Eigen::Matrix<double, 6, 1> innovation(const Eigen::Isometry3d& measured) const;

  geometry::InertialState state_;
  Eigen::Vector3d gravity_;
  Covariance covariance_ = Covariance::Zero();
};

}  // namespace holdfast
