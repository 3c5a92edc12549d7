// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/manifold.h>
#include <ceres/sized_cost_function.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "holdfast/geometry/relative_pose.hpp"
#include "holdfast/geometry/upright_motion.hpp"

namespace holdfast::ceres_plugin {

/// T_camera_world as the solver stores it: quaternion x y z w, translation.
inline Eigen::Isometry3d pose_of(const double* block) {
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() = Eigen::Map<const Eigen::Quaterniond>(block).normalized().toRotationMatrix();
  result.translation() = Eigen::Vector3d::Map(block + 4);
  return result;
}
inline void store(const Eigen::Isometry3d& pose, double* block) {
  Eigen::Vector4d::Map(block) = Eigen::Quaterniond(pose.linear()).normalized().coeffs();
  Eigen::Vector3d::Map(block + 4) = pose.translation();
}

/// Poses moved by a left perturbation: plus(T, d) = exp(d) * T. Cost functions give the derivative by d in the first
/// six of their seven columns, and the seventh is zero; so the derivative of plus that the solver multiplies them with
/// is (identity; 0) and nothing is differentiated twice.
class LeftPerturbation final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    store(geometry::exp_se3(geometry::Vector6d::Map(delta)) * pose_of(x), x_plus_delta);
    return true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    geometry::Vector6d::Map(y_minus_x) = geometry::log_se3(pose_of(y) * pose_of(x).inverse());
    return true;
  }
  bool MinusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }
};

/// Poses moved by left perturbations that keep roll and pitch (geometry::upright_basis()), for the same cost functions.
class UprightPerturbation final : public ceres::Manifold {
 public:
  /// `vertical`: unit vector in the world frame.
  explicit UprightPerturbation(const Eigen::Vector3d& vertical) : vertical_(vertical) {}

  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 4; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    const Eigen::Isometry3d pose = pose_of(x);
    store(geometry::exp_se3(basis(pose) * Eigen::Vector4d::Map(delta)) * pose, x_plus_delta);
    return true;
  }
  bool PlusJacobian(const double* x, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 4, Eigen::RowMajor>> block(jacobian);
    block.topRows<6>() = basis(pose_of(x));
    block.row(6).setZero();
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    const Eigen::Isometry3d pose = pose_of(x);
    Eigen::Vector4d::Map(y_minus_x) = basis(pose).transpose() * geometry::log_se3(pose_of(y) * pose.inverse());
    return true;
  }
  bool MinusJacobian(const double* x, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 4, 7, Eigen::RowMajor>> block(jacobian);
    block.leftCols<6>() = basis(pose_of(x)).transpose();
    block.col(6).setZero();
    return true;
  }

 private:
  geometry::UprightBasis basis(const Eigen::Isometry3d& pose) const {
    return geometry::upright_basis(pose.linear(), vertical_);
  }

  Eigen::Vector3d vertical_;
};

/// Residual log(T_to_from^-1 * T_to * T_from^-1) * scale; blocks: the poses `from` and `to`.
class RelativePoseCost final : public ceres::SizedCostFunction<6, 7, 7> {
 public:
  RelativePoseCost(const Eigen::Isometry3d& T_to_from, double scale) : inverse_(T_to_from.inverse()), scale_(scale) {}

  bool Evaluate(const double* const* parameters, double* residual, double** jacobians) const override {
    const Eigen::Isometry3d from = pose_of(parameters[0]), to = pose_of(parameters[1]);
    if (!jacobians) {
      geometry::Vector6d::Map(residual) = scale_ * geometry::relative_pose_residual(inverse_, from, to);
      return true;
    }
    const geometry::RelativePoseError error = geometry::relative_pose_error(inverse_, from, to);
    geometry::Vector6d::Map(residual) = scale_ * error.residual;
    write(scale_ * error.by_from, jacobians[0]);
    write(scale_ * error.by_to, jacobians[1]);
    return true;
  }

 private:
  static void write(const geometry::Matrix6d& derivative, double* jacobian) {
    if (jacobian == nullptr) return;
    Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>> block(jacobian);
    block.leftCols<6>() = derivative;
    block.col(6).setZero();
  }

  Eigen::Isometry3d inverse_;
  double scale_;
};

}  // namespace holdfast::ceres_plugin
