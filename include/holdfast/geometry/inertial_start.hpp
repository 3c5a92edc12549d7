// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "holdfast/geometry/preintegration.hpp"

/// Initialisation of visual-inertial estimation from visual camera poses: inertial-only maximum a posteriori estimation
/// of Campos, Montiel and Tardos, "Inertial-only optimization for visual-inertial initialization", ICRA 2020.
namespace holdfast::geometry {

/// Settings of start_inertially().
struct InertialStartOptions {
  bool estimate_scale = false;        ///< for monocular poses; otherwise they are in metres
  double gravity = standard_gravity;  ///< [m/s^2]
  /// Standard deviations of the given poses, per axis [m] (after scaling), [rad].
  double position_deviation = 0.002;
  double rotation_deviation = 0.001;
  /// Standard deviations of the biases before any measurement [rad/s], [m/s^2].
  double gyroscope_bias_deviation = 0.1;
  double accelerometer_bias_deviation = 0.2;
  /// Standard deviations of the given calibration: rotation of T_body_camera, per axis [rad], and time offset [s]. With
  /// 0, it is taken as exact.
  double mounting_deviation = 0.0;
  double time_offset_deviation = 0.0;
  int iterations = 15;  ///< at most
  /// A result is usable only with standard deviations up to these: direction of gravity [rad], scale (relative),
  /// velocities [m/s].
  double largest_direction_deviation = 0.03;
  double largest_scale_deviation = 0.02;
  double largest_velocity_deviation = 0.05;
  /// Maximum mean squared normalised residual of a usable result; it is 1 if the stated deviations are correct.
  double largest_mean_chi_square = 4.0;
};

/// Result of start_inertially().
struct InertialStart {
  bool usable = false;  ///< whether the conditions of InertialStartOptions are fulfilled; otherwise try again later
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();  ///< gravity vector in the world frame [m/s^2]
  double scale = 1.0;                                 ///< metres per unit of the given poses
  ImuBias bias;                                       ///< constant over the time of the poses
  /// Corrections of the calibration: R_world_body = R_world_camera * R_camera_body * mounting, and the poses are those
  /// of the body `time_offset` [s] after their time stamps.
  Eigen::Matrix3d mounting = Eigen::Matrix3d::Identity();
  double time_offset = 0.0;
  std::vector<Eigen::Vector3d> velocities;  ///< of the body at each time stamp, in the world [m/s]
  double direction_deviation = std::numeric_limits<double>::infinity();       ///< of gravity [rad], the larger axis
  double scale_deviation = 0.0;                                               ///< relative; 0 if it is not estimated
  double velocity_deviation = std::numeric_limits<double>::infinity();        ///< the largest of all [m/s]
  double gyroscope_bias_deviation = std::numeric_limits<double>::infinity();  ///< the largest axis [rad/s]
  double accelerometer_bias_deviation = std::numeric_limits<double>::infinity();  ///< the largest axis [m/s^2]
  double mean_chi_square = std::numeric_limits<double>::infinity();               ///< mean squared normalised residual
};

namespace detail {

/// The unknowns: velocities of all poses, direction of gravity (2), logarithm of the scale, biases, corrections of the
/// calibration (rotation, time offset).
class InertialStartProblem {
 public:
  InertialStartProblem(std::span<const Eigen::Isometry3d> T_world_camera, std::span<const Preintegration> motions,
                       std::span<const Eigen::Vector3d> angular_velocities, const Eigen::Isometry3d& T_body_camera,
                       const InertialStartOptions& options)
      : poses_(T_world_camera),
        motions_(motions),
        rates_(angular_velocities),
        T_camera_body_(T_body_camera.inverse()),
        options_(options) {}

  InertialStart solve() {
    estimate_gyroscope_bias();
    if (!solve_linearly()) return result_;
    double cost = std::numeric_limits<double>::infinity();
    for (int i = 0; i < options_.iterations; ++i) {
      const double next = iterate();
      if (!std::isfinite(next)) return result_;
      if (std::abs(cost - next) < 1e-6 * next) break;
      cost = next;
    }
    judge();
    return result_;
  }

 private:
  std::size_t count() const { return poses_.size(); }
  int direction_index() const { return static_cast<int>(3 * count()); }
  int scale_index() const { return direction_index() + 2; }
  int bias_index() const { return scale_index() + 1; }
  int mounting_index() const { return bias_index() + 6; }
  int time_index() const { return mounting_index() + 3; }
  int size() const { return time_index() + 1; }
  bool estimates_mounting() const { return options_.mounting_deviation > 0.0; }
  bool estimates_time() const { return options_.time_offset_deviation > 0.0 && rates_.size() == count(); }

  Eigen::Vector3d rate(std::size_t i) const { return rates_[i] - result_.bias.gyroscope; }
  /// At the time stamp of a pose.
  Eigen::Matrix3d body_rotation(std::size_t i) const {
    const Eigen::Matrix3d rotation = poses_[i].linear() * T_camera_body_.linear() * result_.mounting;
    if (!estimates_time()) return rotation;
    return rotation * exp_so3(-result_.time_offset * rate(i)).toRotationMatrix();
  }
  /// Vector from the camera to the body in the world frame [m], which is not scaled.
  Eigen::Vector3d lever(std::size_t i) const { return poses_[i].linear() * T_camera_body_.translation(); }

  InertialState state(std::size_t i) const {
    InertialState state;
    state.T_world_body.linear() = body_rotation(i);
    state.T_world_body.translation() =
        result_.scale * poses_[i].translation() + lever(i) - result_.time_offset * result_.velocities[i];
    state.velocity = result_.velocities[i];
    state.bias = result_.bias;
    return state;
  }

  /// Estimates the gyroscope bias from the rotations alone, by two iterations of linear least squares.
  void estimate_gyroscope_bias() {
    for (int iteration = 0; iteration < 3; ++iteration) {
      Eigen::Matrix3d hessian = 1e-9 * Eigen::Matrix3d::Identity();
      Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
      for (std::size_t i = 0; i + 1 < count(); ++i) {
        const Eigen::Matrix3d jacobian = motions_[i].bias_jacobian().block<3, 3>(inertial::rotation, 0);
        const Eigen::Vector3d error = log_so3(Eigen::Matrix3d(motions_[i].delta(result_.bias).rotation.transpose() *
                                                              body_rotation(i).transpose() * body_rotation(i + 1)));
        hessian += jacobian.transpose() * jacobian;
        gradient += jacobian.transpose() * error;
      }
      result_.bias.gyroscope += hessian.ldlt().solve(gradient);
    }
  }

  /// Initial values of velocities, gravity and scale by linear equations of motion, with zero accelerometer bias.
  bool solve_linearly() {
    const int columns = static_cast<int>(3 * count()) + 4, gravity = columns - 4, scale = columns - 1;
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(columns, columns);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(columns);
    for (std::size_t i = 0; i + 1 < count(); ++i) {
      const double t = motions_[i].duration();
      const InertialDelta delta = motions_[i].delta(result_.bias);
      Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(6, columns);
      Eigen::Matrix<double, 6, 1> values;
      const int v = static_cast<int>(3 * i);
      rows.block<3, 3>(0, v) = -Eigen::Matrix3d::Identity();
      rows.block<3, 3>(0, gravity) = -0.5 * t * Eigen::Matrix3d::Identity();
      rows.block<3, 1>(0, scale) = (poses_[i + 1].translation() - poses_[i].translation()) / t;
      values.head<3>() = (body_rotation(i) * delta.position - lever(i + 1) + lever(i)) / t;
      rows.block<3, 3>(3, v) = -Eigen::Matrix3d::Identity();
      rows.block<3, 3>(3, v + 3).setIdentity();
      rows.block<3, 3>(3, gravity) = -t * Eigen::Matrix3d::Identity();
      values.tail<3>() = body_rotation(i) * delta.velocity;
      hessian += rows.transpose() * rows;
      right += rows.transpose() * values;
    }
    if (!options_.estimate_scale) {  // the scale is 1
      right -= hessian.col(scale);
      hessian.row(scale).setZero(), hessian.col(scale).setZero();
      hessian(scale, scale) = 1.0, right[scale] = 1.0;
    }
    const Eigen::VectorXd solution = hessian.ldlt().solve(right);
    result_.velocities.resize(count());
    for (std::size_t i = 0; i < count(); ++i) result_.velocities[i] = solution.segment<3>(static_cast<int>(3 * i));
    result_.scale = solution[scale];
    result_.gravity = options_.gravity * solution.segment<3>(gravity).normalized();
    return solution.allFinite() && result_.scale > 0.0 && result_.gravity.norm() > 0.0;
  }

  /// Basis of the tangent plane of the direction of gravity, as columns.
  Eigen::Matrix<double, 3, 2> gravity_tangent() const {
    Eigen::Matrix<double, 3, 2> tangent;
    tangent.col(0) = result_.gravity.unitOrthogonal() * options_.gravity;
    tangent.col(1) = result_.gravity.normalized().cross(tangent.col(0));
    return tangent;
  }

  /// Covariance of the residual of position, rotation and velocity, with the errors of both poses.
  Eigen::Matrix<double, 9, 9> residual_covariance(std::size_t i) const {
    Eigen::Matrix<double, 9, 9> covariance = motions_[i].covariance().topLeftCorner<9, 9>();
    covariance.diagonal().segment<3>(inertial::position).array() += 2.0 * std::pow(options_.position_deviation, 2);
    covariance.diagonal().segment<3>(inertial::rotation).array() += 2.0 * std::pow(options_.rotation_deviation, 2);
    return covariance;
  }

  /// One Gauss-Newton step; returns the cost before it.
  double iterate() {
    build_system();
    const Eigen::VectorXd step = hessian_.ldlt().solve(-gradient_);
    if (!step.allFinite()) return std::numeric_limits<double>::quiet_NaN();
    for (std::size_t i = 0; i < count(); ++i) result_.velocities[i] += step.segment<3>(static_cast<int>(3 * i));
    const Eigen::Vector3d moved = result_.gravity + gravity_tangent() * step.segment<2>(direction_index());
    result_.gravity = options_.gravity * moved.normalized();
    result_.scale *= std::exp(std::clamp(step[scale_index()], -0.5, 0.5));
    result_.bias.gyroscope += step.segment<3>(bias_index());
    result_.bias.accelerometer += step.segment<3>(bias_index() + 3);
    result_.mounting = (result_.mounting * exp_so3(step.segment<3>(mounting_index())).toRotationMatrix()).eval();
    result_.time_offset += step[time_index()];
    return cost_;
  }

  void build_system() {
    hessian_ = Eigen::MatrixXd::Zero(size(), size());
    gradient_ = Eigen::VectorXd::Zero(size());
    cost_ = 0.0;
    const auto fix = [this](int index) { hessian_(index, index) = 1.0; };
    if (!options_.estimate_scale) fix(scale_index());
    if (!estimates_mounting())
      for (int i = 0; i < 3; ++i) fix(mounting_index() + i);
    if (!estimates_time()) fix(time_index());
    const Eigen::Matrix<double, 3, 2> tangent = gravity_tangent();
    for (std::size_t i = 0; i + 1 < count(); ++i) add_motion(i, tangent);
    const auto add_prior = [&](int index, const auto& value, double deviation) {
      const double information = 1.0 / (deviation * deviation);
      hessian_.diagonal().segment(index, value.size()).array() += information;
      gradient_.segment(index, value.size()) += information * value;
      cost_ += information * value.squaredNorm();
    };
    add_prior(bias_index(), result_.bias.gyroscope, options_.gyroscope_bias_deviation);
    add_prior(bias_index() + 3, result_.bias.accelerometer, options_.accelerometer_bias_deviation);
    if (estimates_mounting()) add_prior(mounting_index(), log_so3(result_.mounting), options_.mounting_deviation);
    if (estimates_time())
      add_prior(time_index(), Eigen::Matrix<double, 1, 1>(result_.time_offset), options_.time_offset_deviation);
  }

  void add_motion(std::size_t i, const Eigen::Matrix<double, 3, 2>& tangent) {
    InertialJacobians jacobians;
    const Eigen::Matrix<double, 9, 1> error =
        motions_[i].residual(state(i), state(i + 1), result_.gravity, &jacobians).head<9>();
    const Eigen::Matrix<double, 9, 9> information =
        residual_covariance(i).ldlt().solve(Eigen::Matrix<double, 9, 9>::Identity());
    // Columns: both velocities, direction of gravity, scale, biases, rotation and time offset of the calibration.
    Eigen::Matrix<double, 9, 19> jacobian;
    jacobian.leftCols<3>() = jacobians.first.block<9, 3>(0, inertial::velocity);
    jacobian.middleCols<3>(3) = jacobians.second.block<9, 3>(0, inertial::velocity);
    jacobian.middleCols<2>(6) = jacobians.gravity.topRows<9>() * tangent;
    jacobian.col(8).setZero();
    if (options_.estimate_scale)
      jacobian.col(8) =
          result_.scale * (jacobians.first.block<9, 3>(0, inertial::position) * poses_[i].translation() +
                           jacobians.second.block<9, 3>(0, inertial::position) * poses_[i + 1].translation());
    jacobian.middleCols<6>(9) = jacobians.first.block<9, 6>(0, inertial::gyroscope);
    jacobian.rightCols<4>().setZero();
    if (estimates_mounting())
      jacobian.middleCols<3>(15) =
          jacobians.first.block<9, 3>(0, inertial::rotation) + jacobians.second.block<9, 3>(0, inertial::rotation);
    if (estimates_time())
      jacobian.col(18) = -jacobians.first.block<9, 3>(0, inertial::position) * result_.velocities[i] -
                         jacobians.first.block<9, 3>(0, inertial::rotation) * rate(i) -
                         jacobians.second.block<9, 3>(0, inertial::position) * result_.velocities[i + 1] -
                         jacobians.second.block<9, 3>(0, inertial::rotation) * rate(i + 1);
    const Eigen::Matrix<double, 19, 19> block = jacobian.transpose() * information * jacobian;
    const Eigen::Matrix<double, 19, 1> slope = jacobian.transpose() * information * error;
    const int v = static_cast<int>(3 * i), rest = direction_index();
    hessian_.block<6, 6>(v, v) += block.topLeftCorner<6, 6>();
    hessian_.block<6, 13>(v, rest) += block.topRightCorner<6, 13>();
    hessian_.block<13, 6>(rest, v) += block.bottomLeftCorner<13, 6>();
    hessian_.block<13, 13>(rest, rest) += block.bottomRightCorner<13, 13>();
    gradient_.segment<6>(v) += slope.head<6>();
    gradient_.segment<13>(rest) += slope.tail<13>();
    cost_ += error.dot(information * error);
  }

  void judge() {
    build_system();
    const Eigen::MatrixXd covariance = hessian_.ldlt().solve(Eigen::MatrixXd::Identity(size(), size()));
    if (!covariance.allFinite()) return;
    const Eigen::VectorXd deviation = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    result_.velocity_deviation = deviation.head(direction_index()).maxCoeff();
    result_.direction_deviation = deviation.segment<2>(direction_index()).maxCoeff();
    result_.scale_deviation = options_.estimate_scale ? deviation[scale_index()] : 0.0;
    result_.gyroscope_bias_deviation = deviation.segment<3>(bias_index()).maxCoeff();
    result_.accelerometer_bias_deviation = deviation.segment<3>(bias_index() + 3).maxCoeff();
    // Nine residuals a motion, and six of the prior. The calibration's priors are as many as its unknowns.
    const double unknowns = mounting_index() - (options_.estimate_scale ? 0 : 1);
    result_.mean_chi_square = cost_ / std::max(1.0, 9.0 * static_cast<double>(count() - 1) + 6.0 - unknowns);
    result_.usable = result_.direction_deviation <= options_.largest_direction_deviation &&
                     result_.scale_deviation <= options_.largest_scale_deviation &&
                     result_.velocity_deviation <= options_.largest_velocity_deviation &&
                     result_.mean_chi_square <= options_.largest_mean_chi_square;
  }

  std::span<const Eigen::Isometry3d> poses_;
  std::span<const Preintegration> motions_;
  std::span<const Eigen::Vector3d> rates_;
  Eigen::Isometry3d T_camera_body_;
  InertialStartOptions options_;
  InertialStart result_;
  Eigen::MatrixXd hessian_;
  Eigen::VectorXd gradient_;
  double cost_ = 0.0;
};

}  // namespace detail

/// Estimates gravity, biases, velocities and, if asked, the scale from camera poses and the preintegrated measurements
/// between them: motions[i] from pose i to pose i + 1, so that there is one motion less than poses. The poses are not
/// changed. `T_body_camera` is that of ImuCalibration. For metric poses two seconds with ten poses suffice, also at
/// rest, where only the prior separates the accelerometer bias from gravity; monocular poses need about five seconds
/// with accelerations. At least four poses are required.
///
/// Steps: gyroscope bias from the rotations, linear initialisation of the other unknowns, Gauss-Newton iterations on
/// the residuals of equation 13 with priors on the biases. The covariances include the errors of the given poses.
/// `angular_velocities`, measured at each pose [rad/s], are required to estimate the time offset.
inline InertialStart start_inertially(std::span<const Eigen::Isometry3d> T_world_camera,
                                      std::span<const Preintegration> motions, const Eigen::Isometry3d& T_body_camera,
                                      const InertialStartOptions& options = {},
                                      std::span<const Eigen::Vector3d> angular_velocities = {}) {
  if (T_world_camera.size() < 4 || motions.size() + 1 != T_world_camera.size()) return {};
  return detail::InertialStartProblem(T_world_camera, motions, angular_velocities, T_body_camera, options).solve();
}

}  // namespace holdfast::geometry
