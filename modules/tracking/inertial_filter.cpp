// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/inertial_filter.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "holdfast/geometry/preintegration.hpp"

namespace holdfast {

namespace {
constexpr int gravity_index = 15, mounting_index = 18, time_index = 21;
/// Random walk of the direction of gravity in the world of the map, whose vertical drifts [rad/sqrt(s)].
constexpr double direction_walk = 2e-4;
/// Errors of the gyroscope's scale and axes, which calibrations leave, as a share of the rotation.
constexpr double rate_error = 0.005;
/// Errors of scale, axes and time are no white noise: over more than this time [s] they add up, so that deviations grow
/// with the time, not with its root.
constexpr double white_noise_time = 0.2;

Eigen::Matrix3d tangent_projector(const Eigen::Vector3d& gravity) {
  const Eigen::Vector3d down = gravity.normalized();
  return Eigen::Matrix3d::Identity() - down * down.transpose();
}
}  // namespace

InertialFilter::InertialFilter(const geometry::InertialState& state, const Eigen::Vector3d& gravity,
                               const Deviations& deviations)
    : state_(state), gravity_(gravity) {
  using namespace geometry::inertial;
  const auto set = [this](int index, double deviation) {
    covariance_.diagonal().segment<3>(index).setConstant(deviation * deviation);
  };
  set(position, deviations.position);
  set(rotation, deviations.rotation);
  set(velocity, deviations.velocity);
  set(gyroscope, deviations.gyroscope);
  set(accelerometer, deviations.accelerometer);
  set(mounting_index, deviations.mounting);
  covariance_(time_index, time_index) = deviations.time_offset * deviations.time_offset;
  covariance_.block<3, 3>(gravity_index, gravity_index) =
      deviations.direction * deviations.direction * gravity.squaredNorm() * tangent_projector(gravity);
}

InertialFilter::Deviations InertialFilter::deviations() const {
  using namespace geometry::inertial;
  const auto largest = [this](int index) { return std::sqrt(covariance_.diagonal().segment<3>(index).maxCoeff()); };
  return {largest(position),       largest(rotation),
          largest(velocity),       largest(gyroscope),
          largest(accelerometer),  largest(gravity_index) / gravity_.norm(),
          largest(mounting_index), std::sqrt(covariance_(time_index, time_index))};
}

void InertialFilter::predict(const geometry::Preintegration& motion, const Eigen::Vector3d& angular_velocity) {
  const geometry::InertialState next = motion.predict(state_, gravity_);
  geometry::InertialJacobians jacobians;
  motion.residual(state_, next, gravity_, &jacobians);
  // At the prediction the residual is zero: second * d_second + first * d_first + gravity * d_gravity = noise.
  const geometry::Matrix15d inverse = jacobians.second.inverse();
  Covariance transition = Covariance::Identity();
  transition.topLeftCorner<15, 15>() = -inverse * jacobians.first;
  transition.block<15, 3>(0, gravity_index) = -inverse * jacobians.gravity;
  covariance_ = (transition * covariance_ * transition.transpose()).eval();
  // Of the biases too: errors of scale and axes act as biases that change with the motion.
  const double model_factor = std::max(1.0, motion.duration() / white_noise_time);
  covariance_.topLeftCorner<15, 15>() += model_factor * inverse * motion.covariance() * inverse.transpose();
  covariance_.block<3, 3>(gravity_index, gravity_index) +=
      direction_walk * direction_walk * motion.duration() * gravity_.squaredNorm() * tangent_projector(gravity_);
  const double turn = rate_error * geometry::log_so3(motion.delta().rotation).norm();
  covariance_.diagonal().segment<3>(geometry::inertial::rotation).array() += turn * turn;
  state_ = next;
  measured_rate_ = angular_velocity;
}

Eigen::Isometry3d InertialFilter::pose() const {
  Eigen::Isometry3d pose = state_.T_world_body;
  pose.translation() += time_offset_ * state_.velocity;
  pose.linear() =
      pose.linear() * geometry::exp_so3(time_offset_ * angular_velocity()).toRotationMatrix() * mounting_.transpose();
  return pose;
}

/// Derivatives of pose() by the state; its rotation is perturbed from the right, in the axes of the mounted body.
InertialFilter::Observation InertialFilter::observation() const {
  using namespace geometry::inertial;
  Observation result = Observation::Zero();
  result.block<3, 3>(0, position).setIdentity();
  result.block<3, 3>(0, velocity) = time_offset_ * Eigen::Matrix3d::Identity();
  result.block<3, 1>(0, time_index) = state_.velocity;
  result.block<3, 3>(3, rotation) = geometry::exp_so3(-time_offset_ * angular_velocity()).toRotationMatrix();
  result.block<3, 3>(3, gyroscope) = -time_offset_ * Eigen::Matrix3d::Identity();
  result.block<3, 3>(3, mounting_index) = -Eigen::Matrix3d::Identity();
  result.block<3, 1>(3, time_index) = angular_velocity();
  return result;
}

InertialFilter::PoseCovariance InertialFilter::pose_covariance() const {
  const Observation by_state = observation();
  return by_state * covariance_ * by_state.transpose();
}

Eigen::Matrix<double, 6, 1> InertialFilter::innovation(const Eigen::Isometry3d& measured) const {
  const Eigen::Isometry3d predicted = pose();
  Eigen::Matrix<double, 6, 1> result;
  result << measured.translation() - predicted.translation(),
      mounting_.transpose() * geometry::log_so3(Eigen::Matrix3d(predicted.linear().transpose() * measured.linear()));
  return result;
}

double InertialFilter::chi_square(const Eigen::Isometry3d& measured, const PoseCovariance& covariance) const {
  const Eigen::Matrix<double, 6, 1> error = innovation(measured);
  return error.dot((pose_covariance() + covariance).ldlt().solve(error));
}

void InertialFilter::correct(const Eigen::Isometry3d& measured, const PoseCovariance& covariance) {
  const Observation by_state = observation();
  const PoseCovariance total = by_state * covariance_ * by_state.transpose() + covariance;
  const Eigen::Matrix<double, 22, 6> gain = total.ldlt().solve(by_state * covariance_).transpose();
  const Eigen::Matrix<double, 22, 1> correction = gain * innovation(measured);
  state_ = geometry::disturbed(state_, correction.head<15>());
  state_.T_world_body.linear() = Eigen::Quaterniond(state_.T_world_body.linear()).normalized().toRotationMatrix();
  gravity_ = gravity_.norm() * (gravity_ + correction.segment<3>(gravity_index)).normalized();
  mounting_ = Eigen::Quaterniond(mounting_ * geometry::exp_so3(correction.segment<3>(mounting_index)))
                  .normalized()
                  .toRotationMatrix();
  time_offset_ += correction[time_index];
  // Joseph's form keeps the covariance positive.
  const Covariance rest = Covariance::Identity() - gain * by_state;
  covariance_ = (rest * covariance_ * rest.transpose()).eval() + gain * covariance * gain.transpose();
}

void InertialFilter::move(const Eigen::Isometry3d& T_new_old) {
  using namespace geometry::inertial;
  const Eigen::Matrix3d turn = T_new_old.linear();
  state_.T_world_body = T_new_old * state_.T_world_body;
  state_.velocity = turn * state_.velocity;
  gravity_ = turn * gravity_;
  Covariance transition = Covariance::Identity();
  for (const int index : {static_cast<int>(position), static_cast<int>(velocity), gravity_index})
    transition.block<3, 3>(index, index) = turn;
  covariance_ = (transition * covariance_ * transition.transpose()).eval();
}

}  // namespace holdfast
