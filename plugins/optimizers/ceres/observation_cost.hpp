// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/loss_function.h>
#include <ceres/sized_cost_function.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/geometry/pose_problem.hpp"
#include "holdfast/geometry/se3.hpp"

namespace holdfast::ceres_plugin {

/// A pose as the solver sees it: translation, and a rotation vector applied from the left to the first rotation. What
/// the residuals need of it is worked out once per evaluation, not once per observation.
struct PoseState {
  double parameters[6] = {0, 0, 0, 0, 0, 0};
  Eigen::Matrix3d first_rotation = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d left_jacobian = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  void set(const Eigen::Isometry3d& T_camera_world) {
    first_rotation = rotation = T_camera_world.linear();
    translation = T_camera_world.translation();
    Eigen::Vector3d::Map(parameters) = translation;
    Eigen::Vector3d::Map(parameters + 3).setZero();
    left_jacobian.setIdentity();
  }
  void update() {
    const Eigen::Vector3d turn = Eigen::Vector3d::Map(parameters + 3);
    translation = Eigen::Vector3d::Map(parameters);
    rotation = geometry::exp_so3(turn).toRotationMatrix() * first_rotation;
    left_jacobian = geometry::left_jacobian_so3(turn);
  }
  Eigen::Isometry3d T_camera_world() const { return geometry::orthonormalised(exact()); }
  /// The pose of the residuals, to the last bit.
  Eigen::Isometry3d exact() const {
    Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
    result.linear() = rotation;
    result.translation() = translation;
    return result;
  }
};

/// Huber's cost while `is_robust` is set, plain squares otherwise.
class SwitchableHuber final : public ceres::LossFunction {
 public:
  SwitchableHuber(double limit, const bool& is_robust)
      : limit_(limit), threshold_(std::sqrt(limit)), is_robust_(is_robust) {}
  void Evaluate(double squared, double result[3]) const override {
    if (!is_robust_ || squared <= limit_) {
      result[0] = squared, result[1] = 1.0, result[2] = 0.0;
      return;
    }
    const double norm = std::sqrt(squared);
    result[0] = 2.0 * threshold_ * norm - limit_;
    result[1] = threshold_ / norm;
    result[2] = -0.5 * result[1] / squared;
  }

 private:
  double limit_, threshold_;
  const bool& is_robust_;
};

/// A measurement, its scales, and whether it has a say.
struct Measurement {
  double x = 0, y = 0, disparity = 0;  ///< [px]
  double scale = 1;                    ///< of the pixel: square root of inverse_sigma2 * weight
  double disparity_scale = 1;          ///< square root of weight, over the standard deviation of a disparity
  double disparity_threshold = 1;      ///< of Huber's cost of the scaled disparity
  bool active = true;
};

/// Where an evaluation goes: `rows` residuals, and Jacobians in row-major order, rows x 6 of the pose (translation,
/// rotation vector) and rows x 3 of the point; nullptr = not wanted.
struct EvaluationOutput {
  double* residual = nullptr;
  double* pose_jacobian = nullptr;
  double* point_jacobian = nullptr;
};

/// Scaled residual of a point seen from a pose, rows x, y and with rows = 3 the disparity, and its Jacobians. The
/// square of the disparity's row is Huber's cost of it. A point behind the camera has a large residual that does not
/// depend on anything, so that the solver refuses steps that push points there.
template <int rows>
void evaluate_observation(const Camera& camera, const Measurement& measurement, const PoseState& pose,
                          const double* point, const EvaluationOutput& out) {
  const auto [residual, pose_jacobian, point_jacobian] = out;
  using Rows3 = Eigen::Matrix<double, rows, 3, Eigen::RowMajor>;
  const Eigen::Vector3d turned = pose.rotation * Eigen::Map<const Eigen::Vector3d>(point);
  const Eigen::Vector3d p = turned + pose.translation;
  const bool in_front = p.z() > geometry::minimum_depth;
  if (!measurement.active || !in_front) {
    for (int i = 0; i < rows; ++i) residual[i] = measurement.active ? 30.0 * measurement.scale : 0.0;
    if (pose_jacobian) std::fill_n(pose_jacobian, rows * 6, 0.0);
    if (point_jacobian) std::fill_n(point_jacobian, rows * 3, 0.0);
    return;
  }
  const double inverse_z = 1.0 / p.z();
  const double s = measurement.scale;
  const double a = camera.fx * inverse_z, b = camera.fy * inverse_z;
  const double shift = camera.fx * camera.baseline * inverse_z;
  const double column = a * p.x() + camera.cx;
  residual[0] = s * (column - measurement.x);
  residual[1] = s * (b * p.y() + camera.cy - measurement.y);
  double disparity_slope = measurement.disparity_scale;
  if constexpr (rows == 3) {
    residual[2] = measurement.disparity_scale * (shift - measurement.disparity);
    const double threshold = measurement.disparity_threshold, size = std::abs(residual[2]);
    if (size > threshold) {
      const double root = std::sqrt(2.0 * threshold * size - threshold * threshold);
      disparity_slope *= threshold / root;
      residual[2] = std::copysign(root, residual[2]);
    }
  }
  if (!pose_jacobian && !point_jacobian) return;

  Rows3 projection;  // derivative by the point in the camera frame
  projection.row(0) << s * a, 0.0, -s * a * p.x() * inverse_z;
  projection.row(1) << 0.0, s * b, -s * b * p.y() * inverse_z;
  if constexpr (rows == 3) projection.row(2) << 0.0, 0.0, -disparity_slope * shift * inverse_z;
  if (point_jacobian) Eigen::Map<Rows3>(point_jacobian).noalias() = projection * pose.rotation;
  if (pose_jacobian) {
    Eigen::Map<Eigen::Matrix<double, rows, 6, Eigen::RowMajor>> jacobian(pose_jacobian);
    jacobian.template leftCols<3>() = projection;
    Rows3 turn;
    for (int i = 0; i < rows; ++i) turn.row(i) = turned.cross(projection.row(i).transpose()).transpose();
    jacobian.template rightCols<3>().noalias() = turn * pose.left_jacobian;
  }
}

/// Blocks: free pose (6), point (3).
template <int rows>
class FreePoseCost final : public ceres::SizedCostFunction<rows, 6, 3> {
 public:
  FreePoseCost(const Camera& camera, const Measurement& measurement, const PoseState& pose)
      : camera_(camera), measurement_(measurement), pose_(pose) {}
  bool Evaluate(const double* const* parameters, double* residual, double** jacobians) const override {
    evaluate_observation<rows>(camera_, measurement_, pose_, parameters[1],
                               {.residual = residual,
                                .pose_jacobian = jacobians ? jacobians[0] : nullptr,
                                .point_jacobian = jacobians ? jacobians[1] : nullptr});
    return true;
  }

 private:
  const Camera& camera_;
  const Measurement& measurement_;
  const PoseState& pose_;
};

/// One observation from a fixed pose.
struct FixedObservation {
  Measurement measurement;
  const PoseState* pose = nullptr;
  double limit = 0;  ///< of Huber's cost, times weight
  bool has_right = false;
};

/// All observations of a point from fixed poses as one block of four residuals, which spares the solver most of its
/// rows. Block: point (3).
///
/// With H = sum of rho' J^T J and g = sum of rho' J^T r over the observations, and H = L L^T, the residual is
/// (L^-1 g, e) and its Jacobian (L^T, 0): the same Gauss-Newton system and gradient as row by row. e fills the square
/// up to the sum of rho, which never is less than |L^-1 g|^2, because rho >= rho' s for Huber's cost.
class FixedPosesCost final : public ceres::SizedCostFunction<4, 3> {
 public:
  /// `is_robust` is looked at in every evaluation: Huber's cost or plain squares.
  FixedPosesCost(const Camera& camera, std::span<const FixedObservation> observations, const bool& is_robust)
      : camera_(camera), observations_(observations), is_robust_(is_robust) {}

  bool Evaluate(const double* const* parameters, double* residual, double** jacobians) const override {
    const bool linearise = jacobians && jacobians[0];
    Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    double squared_sum = 0.0;
    for (const FixedObservation& observation : observations_) {
      const auto accumulate = [&]<int rows>() {
        Eigen::Matrix<double, rows, 1> error;
        Eigen::Matrix<double, rows, 3, Eigen::RowMajor> jacobian;
        evaluate_observation<rows>(camera_, observation.measurement, *observation.pose, parameters[0],
                                   {.residual = error.data(), .point_jacobian = linearise ? jacobian.data() : nullptr});
        const double squared = error.squaredNorm();
        const bool beyond = is_robust_ && squared > observation.limit;
        const double slope = beyond ? std::sqrt(observation.limit / squared) : 1.0;
        squared_sum += beyond ? 2.0 * slope * squared - observation.limit : squared;
        if (!linearise) return;
        hessian.noalias() += slope * (jacobian.transpose() * jacobian);
        gradient.noalias() += slope * (jacobian.transpose() * error);
      };
      observation.has_right ? accumulate.template operator()<3>() : accumulate.template operator()<2>();
    }
    std::fill_n(residual, 4, 0.0);
    if (linearise) {
      Eigen::Map<Eigen::Matrix<double, 4, 3, Eigen::RowMajor>> jacobian(jacobians[0]);
      jacobian.setZero();
      factor(hessian, gradient, jacobian, residual);
      for (int i = 0; i < 3; ++i) squared_sum -= residual[i] * residual[i];
    }
    residual[3] = std::sqrt(std::max(0.0, squared_sum));
    return true;
  }

 private:
  /// Cholesky's factor of a matrix that may be singular: directions without information get a row of zeros.
  template <class Jacobian>
  static void factor(const Eigen::Matrix3d& hessian, const Eigen::Vector3d& gradient, Jacobian& jacobian,
                     double* residual) {
    for (int i = 0; i < 3; ++i) {
      double pivot = hessian(i, i), right = gradient[i];
      for (int k = 0; k < i; ++k) pivot -= jacobian(k, i) * jacobian(k, i), right -= jacobian(k, i) * residual[k];
      if (!(pivot > 1e-12 * hessian(i, i))) continue;
      const double root = std::sqrt(pivot);
      jacobian(i, i) = root;
      residual[i] = right / root;
      for (int j = i + 1; j < 3; ++j) {
        double value = hessian(i, j);
        for (int k = 0; k < i; ++k) value -= jacobian(k, i) * jacobian(k, j);
        jacobian(i, j) = value / root;
      }
    }
  }

  const Camera& camera_;
  std::span<const FixedObservation> observations_;
  const bool& is_robust_;
};

}  // namespace holdfast::ceres_plugin
