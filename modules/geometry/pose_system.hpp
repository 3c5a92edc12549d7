// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/geometry/se3.hpp"
#include "holdfast/interfaces/optimizer.hpp"

namespace holdfast::geometry {

/// Four observations side by side. The width is fixed, so that sums have the same order whatever the processor offers.
using Batch = double __attribute__((vector_size(32)));
inline constexpr std::size_t batch_size = 4;

/// Four observations of a pose problem, ready for arithmetic. What cannot be used has information and weight 0. The
/// alignment is spelled out because the baseline compiler would take 16 bytes and the AVX2 kernel relies on 32.
struct alignas(32) ObservationBatch {
  Batch point_x, point_y, point_z;  ///< world [m]
  Batch x, y, right_x;              ///< [px]
  Batch information;                ///< of x and y [1/px^2]
  Batch information_right;          ///< of right_x, 0 where there is none
  Batch limit;                      ///< chi-square limit, and square of Huber's threshold
  Batch full_weight;                ///< of the observation's cost while it is no outlier
  Batch weight;                     ///< full_weight, or 0 in a round in which the observation is an outlier
  Batch chi_square;                 ///< by chi_squares()
};

/// The normal equations of a left perturbation (translation, rotation) of T_camera_world.
struct PoseSystem {
  Matrix6d hessian;
  Vector6d gradient;
  double cost = 0.0;  ///< half the weighted sum of (robust) squared residuals
};

/// Throws CheckError unless there is a camera and every array of the observations has one entry a point.
void check_pose_problem(const PoseProblem& problem);

/// What the kernels need of camera and pose.
struct PoseView {
  PoseView(const Camera& camera, const Eigen::Isometry3d& T_camera_world);
  double rotation[9];  ///< row by row
  double translation[3];
  double fx, fy, cx, cy, fx_baseline;
};

/// Builds the normal equations; Jacobians in closed form. `robust`: Huber's cost, else plain squares.
void build_system(const std::vector<ObservationBatch>& batches, const PoseView& view, bool robust, PoseSystem& system);

/// Fills chi_square: squared residuals times information; infinite behind the camera.
void chi_squares(std::vector<ObservationBatch>& batches, const PoseView& view);

}  // namespace holdfast::geometry
