// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>

#include "holdfast/core/imu_sample.hpp"
#include "holdfast/geometry/inertial_state.hpp"
#include "holdfast/geometry/so3.hpp"

/// Preintegration of inertial measurements on the manifold, after Forster, Carlone, Dellaert and Scaramuzza,
/// "On-manifold preintegration for real-time visual-inertial odometry", TRO 2017 (sections V and VI), with two
/// deviations: a step is integrated exactly for measurements that are constant in the body frame, and the random walk
/// of the biases is part of the covariance. Errors are those of inertial_state.hpp.
namespace holdfast::geometry {

/// Applies an error to a state.
inline InertialState disturbed(InertialState state, const Vector15d& error) {
  state.T_world_body.translation() += error.segment<3>(inertial::position);
  state.T_world_body.linear() =
      state.T_world_body.linear() * exp_so3(error.segment<3>(inertial::rotation)).toRotationMatrix();
  state.velocity += error.segment<3>(inertial::velocity);
  state.bias.gyroscope += error.segment<3>(inertial::gyroscope);
  state.bias.accelerometer += error.segment<3>(inertial::accelerometer);
  return state;
}

/// Change of position, rotation and velocity in the body frame at the beginning, without gravity and initial velocity
/// (equation 33).
struct InertialDelta {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< [m/s]
};

/// Derivatives of the residual of a preintegrated motion.
struct InertialJacobians {
  Matrix15d first;                       ///< by the error of the state at the beginning
  Matrix15d second;                      ///< by the error of the state at the end
  Eigen::Matrix<double, 15, 3> gravity;  ///< by the vector of gravity in the world frame
};

namespace detail {

/// The entire function c_n(s) = sum over k of (-s)^k / (2k + n)! and its derivative by s, for 0 <= s <= 1: sin(x) / x,
/// (1 - cos(x)) / x^2, (x - sin(x)) / x^3, (cos(x) - 1 + x^2 / 2) / x^4 for n = 1 to 4 and s = x^2.
struct RotationSeries {
  double value = 0.0, slope = 0.0;
};
inline RotationSeries rotation_series(int n, double s) {
  double factor = 1.0;  // (-1)^k / (2k + n)!
  for (int i = 2; i <= n; ++i) factor /= i;
  RotationSeries series{factor, 0.0};
  double power = 1.0;  // s^(k - 1)
  for (int k = 1; k <= 8; ++k) {
    factor /= -static_cast<double>((2 * k + n - 1) * (2 * k + n));
    series.slope += k * factor * power;
    power *= s;
    series.value += factor * power;
  }
  return series;
}

/// Product of (first I + a hat(r) + b hat(r)^2) and a vector, and its derivatives by both.
struct RotatedVector {
  Eigen::Vector3d value;
  Eigen::Matrix3d by_vector, by_rotation;
};
inline RotatedVector rotated_vector(double first, const RotationSeries& a, const RotationSeries& b,
                                    const Eigen::Vector3d& rotation, const Eigen::Vector3d& vector) {
  const Eigen::Matrix3d cross = hat(rotation);
  const Eigen::Vector3d once = cross * vector, twice = cross * once;
  RotatedVector result;
  result.by_vector = first * Eigen::Matrix3d::Identity() + a.value * cross + b.value * cross * cross;
  result.value = first * vector + a.value * once + b.value * twice;
  result.by_rotation = -a.value * hat(vector) +
                       b.value * (rotation.dot(vector) * Eigen::Matrix3d::Identity() + rotation * vector.transpose() -
                                  2.0 * vector * rotation.transpose()) +
                       2.0 * (a.slope * once + b.slope * twice) * rotation.transpose();
  return result;
}

}  // namespace detail

/// Preintegrated inertial measurements between two times: delta, its derivatives by the biases, and covariance. The
/// delta assumes constant biases; the covariance contains their random walk.
class Preintegration {
 public:
  explicit Preintegration(const ImuNoise& noise = {}, const ImuBias& bias = {}) : noise_(noise), bias_(bias) {}

  /// Appends a measurement that is constant in the body frame for `interval` seconds (> 0).
  void integrate(const Eigen::Vector3d& angular_velocity, const Eigen::Vector3d& acceleration, double interval) {
    const Eigen::Vector3d rate = angular_velocity - bias_.gyroscope, force = acceleration - bias_.accelerometer;
    // The series of a step converge for rotations up to 1 rad.
    const int steps = std::max(1, static_cast<int>(std::ceil(rate.norm() * interval)));
    for (int i = 0; i < steps; ++i) step(rate, force, interval / steps);
  }

  double duration() const { return duration_; }          ///< [s]
  const ImuBias& bias() const { return bias_; }          ///< that was subtracted from the measurements
  const InertialDelta& delta() const { return delta_; }  ///< for bias()
  /// Derivatives of the delta by the biases, in the order of the error: rows position, rotation (from the right) and
  /// velocity; columns gyroscope and accelerometer (equation 44).
  Eigen::Matrix<double, 9, 6> bias_jacobian() const { return jacobian_; }
  /// Covariance of the residual: of the delta, in the body frame at the beginning, and of the change of the biases.
  const Matrix15d& covariance() const { return covariance_; }

  /// The delta for other biases, to first order in their difference from bias() (equation 44).
  InertialDelta delta(const ImuBias& bias) const {
    Eigen::Matrix<double, 6, 1> change;
    change << bias.gyroscope - bias_.gyroscope, bias.accelerometer - bias_.accelerometer;
    const Eigen::Matrix<double, 9, 1> d = jacobian_ * change;
    return {delta_.position + d.segment<3>(inertial::position),
            delta_.rotation * exp_so3(d.segment<3>(inertial::rotation)).toRotationMatrix(),
            delta_.velocity + d.segment<3>(inertial::velocity)};
  }

  /// Predicts the state at the end from that at the beginning. `gravity` is the gravity vector in the world frame, (0,
  /// 0, -9.81) if z points up.
  InertialState predict(const InertialState& first, const Eigen::Vector3d& gravity) const {
    const InertialDelta change = delta(first.bias);
    const Eigen::Matrix3d turn = first.T_world_body.linear();
    InertialState second = first;
    second.T_world_body.translation() +=
        duration_ * (first.velocity + 0.5 * duration_ * gravity) + turn * change.position;
    second.T_world_body.linear() = turn * change.rotation;
    second.velocity += duration_ * gravity + turn * change.velocity;
    return second;
  }

  /// Covariance of the predicted state, from that of the state at the beginning.
  Matrix15d predicted_covariance(const InertialState& first, const Matrix15d& covariance,
                                 const Eigen::Vector3d& gravity) const {
    InertialJacobians jacobians;
    residual(first, predict(first, gravity), gravity, &jacobians);
    // At the prediction the residual is zero: second * d_second + first * d_first = noise.
    const Matrix15d inverse = jacobians.second.inverse();
    const Matrix15d transition = inverse * jacobians.first;
    return transition * covariance * transition.transpose() + inverse * covariance_ * inverse.transpose();
  }

  /// Difference between the motion from one state to another and the preintegrated one, in the order of the error
  /// (equations 45 and 47): position, rotation and velocity in the body frame at the beginning, and the change of the
  /// biases. Its covariance is covariance().
  Vector15d residual(const InertialState& first, const InertialState& second, const Eigen::Vector3d& gravity,
                     InertialJacobians* jacobians = nullptr) const {
    using namespace inertial;
    const InertialDelta change = delta(first.bias);
    const Eigen::Matrix3d R_body_world = first.T_world_body.linear().transpose();
    const Eigen::Vector3d moved = R_body_world * (second.T_world_body.translation() - first.T_world_body.translation() -
                                                  duration_ * (first.velocity + 0.5 * duration_ * gravity));
    const Eigen::Vector3d accelerated = R_body_world * (second.velocity - first.velocity - duration_ * gravity);
    Vector15d result;
    result.segment<3>(position) = moved - change.position;
    result.segment<3>(rotation) =
        log_so3(Eigen::Matrix3d(change.rotation.transpose() * R_body_world * second.T_world_body.linear()));
    result.segment<3>(velocity) = accelerated - change.velocity;
    result.segment<3>(gyroscope) = second.bias.gyroscope - first.bias.gyroscope;
    result.segment<3>(accelerometer) = second.bias.accelerometer - first.bias.accelerometer;
    if (jacobians != nullptr) *jacobians = derivatives(first, second, moved, accelerated, result.segment<3>(rotation));
    return result;
  }

 private:
  void step(const Eigen::Vector3d& rate, const Eigen::Vector3d& force, double interval) {
    using namespace inertial;
    const Eigen::Vector3d turn = rate * interval;
    const double s = turn.squaredNorm();
    const detail::RotationSeries c2 = detail::rotation_series(2, s), c3 = detail::rotation_series(3, s),
                                 c4 = detail::rotation_series(4, s);
    // Integrals of exp(rate t) * force over the step, once and twice.
    const detail::RotatedVector once = detail::rotated_vector(1.0, c2, c3, turn, force);
    const detail::RotatedVector twice = detail::rotated_vector(0.5, c3, c4, turn, force);
    const double dt = interval, dt2 = dt * dt;
    const Eigen::Matrix3d R = delta_.rotation;
    const Eigen::Matrix3d turned = exp_so3(turn).toRotationMatrix();

    // Transition of the error of delta and biases, and its derivative by the measurement (appendix "Iterative Noise
    // Propagation").
    Matrix15d transition = Matrix15d::Identity();
    transition.block<3, 3>(position, rotation) = -dt2 * R * hat(twice.value);
    transition.block<3, 3>(position, velocity) = dt * Eigen::Matrix3d::Identity();
    transition.block<3, 3>(rotation, rotation) = turned.transpose();
    transition.block<3, 3>(velocity, rotation) = -dt * R * hat(once.value);
    Eigen::Matrix<double, 9, 6> measured;
    measured.block<3, 3>(position, 0) = dt2 * dt * R * twice.by_rotation;
    measured.block<3, 3>(position, 3) = dt2 * R * twice.by_vector;
    measured.block<3, 3>(rotation, 0) = dt * left_jacobian_so3(-turn);
    measured.block<3, 3>(rotation, 3).setZero();
    measured.block<3, 3>(velocity, 0) = dt2 * R * once.by_rotation;
    measured.block<3, 3>(velocity, 3) = dt * R * once.by_vector;
    transition.topRightCorner<9, 6>() = -measured;

    jacobian_ = (transition.topLeftCorner<9, 9>() * jacobian_ - measured).eval();
    Eigen::Matrix<double, 6, 1> white, walk;
    white << Eigen::Vector3d::Constant(noise_.gyroscope_noise_density),
        Eigen::Vector3d::Constant(noise_.accelerometer_noise_density);
    walk << Eigen::Vector3d::Constant(noise_.gyroscope_random_walk),
        Eigen::Vector3d::Constant(noise_.accelerometer_random_walk);
    covariance_ = (transition * covariance_ * transition.transpose()).eval();
    const Eigen::Matrix<double, 9, 6> scaled = measured * white.asDiagonal();
    covariance_.topLeftCorner<9, 9>() += scaled * scaled.transpose() / dt;
    covariance_.diagonal().tail<6>() += dt * walk.cwiseAbs2();

    delta_.position += dt * delta_.velocity + dt2 * R * twice.value;
    delta_.velocity += dt * R * once.value;
    delta_.rotation = Eigen::Quaterniond(R * turned).normalized().toRotationMatrix();
    duration_ += dt;
  }

  InertialJacobians derivatives(const InertialState& first, const InertialState& second, const Eigen::Vector3d& moved,
                                const Eigen::Vector3d& accelerated, const Eigen::Vector3d& rotation_residual) const {
    using namespace inertial;
    const Eigen::Matrix3d R_body_world = first.T_world_body.linear().transpose();
    const Eigen::Matrix3d right_inverse = left_jacobian_inverse_so3(-rotation_residual);
    InertialJacobians result{Matrix15d::Zero(), Matrix15d::Zero(), Eigen::Matrix<double, 15, 3>::Zero()};
    Matrix15d& a = result.first;
    a.block<3, 3>(position, position) = -R_body_world;
    a.block<3, 3>(position, rotation) = hat(moved);
    a.block<3, 3>(position, velocity) = -duration_ * R_body_world;
    a.block<3, 3>(rotation, rotation) =
        -right_inverse * second.T_world_body.linear().transpose() * first.T_world_body.linear();
    a.block<3, 3>(velocity, rotation) = hat(accelerated);
    a.block<3, 3>(velocity, velocity) = -R_body_world;
    a.block<9, 6>(0, gyroscope) = -jacobian_;
    // The delta's rotation is corrected by exp(jacobian * change), whose derivative is a right Jacobian.
    const Eigen::Vector3d correction =
        jacobian_.block<3, 3>(rotation, 0) * (first.bias.gyroscope - bias_.gyroscope) +
        jacobian_.block<3, 3>(rotation, 3) * (first.bias.accelerometer - bias_.accelerometer);
    a.block<3, 6>(rotation, gyroscope) = -left_jacobian_inverse_so3(rotation_residual) *
                                         left_jacobian_so3(-correction) * jacobian_.middleRows<3>(rotation);
    a.bottomRightCorner<6, 6>() = -Eigen::Matrix<double, 6, 6>::Identity();
    Matrix15d& b = result.second;
    b.block<3, 3>(position, position) = R_body_world;
    b.block<3, 3>(rotation, rotation) = right_inverse;
    b.block<3, 3>(velocity, velocity) = R_body_world;
    b.bottomRightCorner<6, 6>().setIdentity();
    result.gravity.middleRows<3>(position) = -0.5 * duration_ * duration_ * R_body_world;
    result.gravity.middleRows<3>(velocity) = -duration_ * R_body_world;
    return result;
  }

  ImuNoise noise_;
  ImuBias bias_;
  double duration_ = 0.0;
  InertialDelta delta_;
  Eigen::Matrix<double, 9, 6> jacobian_ = Eigen::Matrix<double, 9, 6>::Zero();
  Matrix15d covariance_ = Matrix15d::Zero();
};

/// The measurement at a time between two samples, by linear interpolation.
inline ImuSample interpolated(const ImuSample& a, const ImuSample& b, double timestamp) {
  const double share = b.timestamp > a.timestamp ? (timestamp - a.timestamp) / (b.timestamp - a.timestamp) : 0.0;
  return {timestamp, a.angular_velocity + share * (b.angular_velocity - a.angular_velocity),
          a.acceleration + share * (b.acceleration - a.acceleration)};
}

/// Preintegrates the measurements from `begin` to `end` [s]. Between neighbouring samples, whose time stamps increase
/// strictly, the mean of both is constant; at both ends they are interpolated. Empty if the samples do not cover the
/// whole time, or leave a gap of more than `largest_gap` [s] in it.
inline std::optional<Preintegration> preintegrate(std::span<const ImuSample> samples, double begin, double end,
                                                  const ImuNoise& noise, const ImuBias& bias,
                                                  double largest_gap = 0.1) {
  if (samples.size() < 2 || !(begin < end) || samples.front().timestamp > begin || samples.back().timestamp < end)
    return std::nullopt;
  const auto is_earlier = [](double time, const ImuSample& sample) { return time < sample.timestamp; };
  const auto after = std::upper_bound(samples.begin() + 1, samples.end() - 1, begin, is_earlier);
  Preintegration result(noise, bias);
  ImuSample from = interpolated(*(after - 1), *after, begin);
  for (auto next = after; next != samples.end() && from.timestamp < end; ++next) {
    if (!(next->timestamp - (next - 1)->timestamp <= largest_gap)) return std::nullopt;
    const ImuSample to = next->timestamp <= end ? *next : interpolated(*(next - 1), *next, end);
    const double interval = to.timestamp - from.timestamp;
    if (interval > 0.0)
      result.integrate(0.5 * (from.angular_velocity + to.angular_velocity), 0.5 * (from.acceleration + to.acceleration),
                       interval);
    from = to;
  }
  return result;
}

}  // namespace holdfast::geometry
