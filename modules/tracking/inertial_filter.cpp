// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/inertial_filter.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "holdfast/geometry/preintegration.hpp"

namespace holdfast {

namespace {
constexpr int gravity_index = 15;
/// Random walk of the direction of gravity in the world of the map, whose vertical drifts [rad/sqrt(s)].
constexpr double direction_walk = 2e-4;

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
  covariance_.bottomRightCorner<3, 3>() =
      deviations.direction * deviations.direction * gravity.squaredNorm() * tangent_projector(gravity);
}

void InertialFilter::predict(const geometry::Preintegration& motion) {
  const geometry::InertialState next = motion.predict(state_, gravity_);
  geometry::InertialJacobians jacobians;
  motion.residual(state_, next, gravity_, &jacobians);
  // At the prediction the residual is zero: second * d_second + first * d_first + gravity * d_gravity = noise.
  const geometry::Matrix15d inverse = jacobians.second.inverse();
  Covariance transition = Covariance::Identity();
  transition.topLeftCorner<15, 15>() = -inverse * jacobians.first;
  transition.topRightCorner<15, 3>() = -inverse * jacobians.gravity;
  covariance_ = (transition * covariance_ * transition.transpose()).eval();
  covariance_.topLeftCorner<15, 15>() += inverse * motion.covariance() * inverse.transpose();
  covariance_.bottomRightCorner<3, 3>() +=
      direction_walk * direction_walk * motion.duration() * gravity_.squaredNorm() * tangent_projector(gravity_);
  state_ = next;
}

Eigen::Matrix<double, 6, 1> InertialFilter::innovation(const Eigen::Isometry3d& measured) const {
  Eigen::Matrix<double, 6, 1> result;
  result << measured.translation() - state_.T_world_body.translation(),
      geometry::log_so3(Eigen::Matrix3d(state_.T_world_body.linear().transpose() * measured.linear()));
  return result;
}

double InertialFilter::chi_square(const Eigen::Isometry3d& measured, const PoseCovariance& covariance) const {
  const Eigen::Matrix<double, 6, 1> error = innovation(measured);
  return error.dot((pose_covariance() + covariance).ldlt().solve(error));
}

void InertialFilter::correct(const Eigen::Isometry3d& measured, const PoseCovariance& covariance) {
  const PoseCovariance total = pose_covariance() + covariance;
  const Eigen::Matrix<double, 18, 6> gain = total.ldlt().solve(covariance_.topRows<6>()).transpose();
  const Eigen::Matrix<double, 18, 1> correction = gain * innovation(measured);
  state_ = geometry::disturbed(state_, correction.head<15>());
  state_.T_world_body.linear() = Eigen::Quaterniond(state_.T_world_body.linear()).normalized().toRotationMatrix();
  gravity_ = gravity_.norm() * (gravity_ + correction.tail<3>()).normalized();
  // Joseph's form keeps the covariance positive.
  Covariance rest = Covariance::Identity();
  rest.leftCols<6>() -= gain;
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
