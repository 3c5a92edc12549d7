// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/evaluation_callback.h>
#include <ceres/loss_function.h>
#include <ceres/sized_cost_function.h>

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/geometry/pose_adjustment.hpp"
#include "holdfast/geometry/so3.hpp"

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
  Eigen::Isometry3d T_camera_world() const {
    Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
    result.linear() = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
    result.translation() = translation;
    return result;
  }
};

/// Brings the derived parts of the free poses up to date before each evaluation.
class PoseUpdater final : public ceres::EvaluationCallback {
 public:
  explicit PoseUpdater(std::vector<PoseState>& poses) : poses_(poses) {}
  void PrepareForEvaluation(bool, bool new_evaluation_point) override {
    if (new_evaluation_point)
      for (PoseState& pose : poses_) pose.update();
  }

 private:
  std::vector<PoseState>& poses_;
};

/// Huber's cost with a limit that can be lifted between two solves.
class SwitchableHuber final : public ceres::LossFunction {
 public:
  explicit SwitchableHuber(double limit) : limit_(limit), threshold_(std::sqrt(limit)) {}
  void lift() { is_lifted_ = true; }
  void Evaluate(double squared, double result[3]) const override {
    if (is_lifted_ || squared <= limit_) {
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
  bool is_lifted_ = false;
};

/// A measurement, its scale, and whether it has a say.
struct Measurement {
  double x = 0, y = 0, right_x = 0;  ///< [px]
  double scale = 1;                  ///< square root of inverse_sigma2 * weight
  bool active = true;
};

/// Scaled residual of a point seen from a pose, rows x, y and with rows = 3 right_x. Jacobians row by row: of the pose
/// (translation, rotation vector) and of the point; either may be null. A point behind the camera has a large residual
/// that does not depend on anything, so that the solver refuses steps that push points there.
template <int rows>
void evaluate_observation(const Camera& camera, const Measurement& measurement, const PoseState& pose,
                          const double* point, double* residual, double* pose_jacobian, double* point_jacobian) {
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
  if constexpr (rows == 3) residual[2] = s * (column - shift - measurement.right_x);
  if (!pose_jacobian && !point_jacobian) return;

  Rows3 projection;  // derivative by the point in the camera frame
  projection.row(0) << s * a, 0.0, -s * a * p.x() * inverse_z;
  projection.row(1) << 0.0, s * b, -s * b * p.y() * inverse_z;
  if constexpr (rows == 3) projection.row(2) << s * a, 0.0, s * (shift - a * p.x()) * inverse_z;
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
    evaluate_observation<rows>(camera_, measurement_, pose_, parameters[1], residual,
                               jacobians ? jacobians[0] : nullptr, jacobians ? jacobians[1] : nullptr);
    return true;
  }

 private:
  const Camera& camera_;
  const Measurement& measurement_;
  const PoseState& pose_;
};

/// Block: point (3).
template <int rows>
class FixedPoseCost final : public ceres::SizedCostFunction<rows, 3> {
 public:
  FixedPoseCost(const Camera& camera, const Measurement& measurement, const PoseState& pose)
      : camera_(camera), measurement_(measurement), pose_(pose) {}
  bool Evaluate(const double* const* parameters, double* residual, double** jacobians) const override {
    evaluate_observation<rows>(camera_, measurement_, pose_, parameters[0], residual, nullptr,
                               jacobians ? jacobians[0] : nullptr);
    return true;
  }

 private:
  const Camera& camera_;
  const Measurement& measurement_;
  const PoseState& pose_;
};

}  // namespace holdfast::ceres_plugin
