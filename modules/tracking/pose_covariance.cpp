// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/pose_covariance.hpp"

#include <algorithm>
#include <cmath>

namespace holdfast {

namespace {

using geometry::Matrix6d;
using geometry::Vector6d;

/// Residuals of one match at the solution. The disparity has the noise and the robust cost of adjust_pose().
struct Residuals {
  Eigen::Vector3d point;               ///< in the camera frame
  double x, y;                         ///< [px]
  double disparity = 0.0;              ///< [px]
  double disparity_information = 0.0;  ///< with its robust weight; 0 where there is none
  double pixel_squares() const { return x * x + y * y; }
  double disparity_squares() const { return disparity_information * disparity * disparity; }
};

bool counts(const PoseProblem& problem, std::size_t i) { return problem.inlier[i] != 0 && problem.weight[i] > 0.0F; }

Residuals residuals_of(const PoseProblem& problem, const geometry::Pinhole& camera, std::size_t i) {
  Residuals r;
  r.point = problem.T_camera_world * problem.points[i];
  r.x = camera.fx * r.point.x() / r.point.z() + camera.cx - problem.x[i];
  r.y = camera.fy * r.point.y() / r.point.z() + camera.cy - problem.y[i];
  if (std::isnan(problem.right_x[i])) return r;
  r.disparity = camera.fx * camera.baseline / r.point.z() - (static_cast<double>(problem.x[i]) - problem.right_x[i]);
  const double deviations = std::abs(r.disparity) / geometry::disparity_sigma;
  const double robust = std::min(1.0, geometry::disparity_threshold / std::max(deviations, 1e-9));
  r.disparity_information = robust / (geometry::disparity_sigma * geometry::disparity_sigma);
  return r;
}

/// Half the gradient of a match's cost by a left perturbation of T_camera_world.
Vector6d gradient_of(const PoseProblem& problem, const geometry::Pinhole& camera, std::size_t i) {
  const Residuals r = residuals_of(problem, camera, i);
  const double inverse_z = 1.0 / r.point.z();
  const double x = problem.inverse_sigma2[i] * camera.fx * inverse_z * r.x;
  const double y = problem.inverse_sigma2[i] * camera.fy * inverse_z * r.y;
  const double disparity = r.disparity_information * camera.fx * camera.baseline * inverse_z * inverse_z * r.disparity;
  const Eigen::Vector3d by_point(x, y, -inverse_z * (r.point.x() * x + r.point.y() * y) - disparity);
  Vector6d gradient;
  gradient << by_point, r.point.cross(by_point);
  return problem.weight[i] * gradient;
}

/// Sum of the squared weighted residuals of the inliers by their degrees of freedom.
double variance_factor(const PoseProblem& problem) {
  constexpr double least = 0.01;  // noise of 0.1 px: smaller residuals are chance or synthetic
  const auto camera = problem.camera->pinhole();
  double sum = 0.0;
  int residuals = 0;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    if (!counts(problem, i)) continue;
    const Residuals r = residuals_of(problem, camera, i);
    residuals += r.disparity_information > 0.0 ? 3 : 2;
    sum += problem.weight[i] * (problem.inverse_sigma2[i] * r.pixel_squares() + r.disparity_squares());
  }
  return std::max(least, sum / std::max(1, residuals - 6));
}

/// The cell of a coordinate, which may lie outside the image.
std::size_t cell_of(double coordinate, double side, std::size_t cells) {
  return static_cast<std::size_t>(std::clamp(coordinate / side, 0.0, static_cast<double>(cells - 1)));
}

}  // namespace

Matrix6d PoseCovariance::independent(const PoseProblem& problem, const Matrix6d& inverse_information) {
  return variance_factor(problem) * inverse_information;
}

Matrix6d PoseCovariance::clustered(const PoseProblem& problem, const Matrix6d& inverse_information) {
  const auto camera = problem.camera->pinhole();
  const double side = cell_angle * camera.fx;
  const auto columns = static_cast<std::size_t>(problem.camera->width / side) + 1;
  const auto rows = static_cast<std::size_t>(problem.camera->height / side) + 1;
  gradients_.assign(columns * rows, Vector6d::Zero());
  for (std::size_t i = 0; i < problem.size(); ++i) {
    if (!counts(problem, i)) continue;
    const std::size_t cell = cell_of(problem.y[i], side, rows) * columns + cell_of(problem.x[i], side, columns);
    gradients_[cell] += gradient_of(problem, camera, i);
  }
  Matrix6d sum = Matrix6d::Zero();
  for (const Vector6d& gradient : gradients_) sum += gradient * gradient.transpose();
  return inverse_information * sum * inverse_information;
}

Matrix6d PoseCovariance::calibrated_covariance(const PoseProblem& problem, const Matrix6d& inverse_information,
                                               KeyFrameId reference, const Eigen::Isometry3d& T_current_reference) {
  frame_ = independent(problem, inverse_information);
  has_frame_ = true;
  Matrix6d keyframe = frame_;
  if (const Matrix6d* known = find(reference)) {
    const Matrix6d to_current = geometry::adjoint_se3(T_current_reference);
    const Matrix6d moved = to_current * *known * to_current.transpose();
    // Compared in units of this frame's covariance.
    if (frame_.llt().solve(moved).trace() > 6.0) keyframe = moved;
  }
  return independent_share * (clustered(problem, inverse_information) + keyframe);
}

void PoseCovariance::keyframe_added(KeyFrameId keyframe) {
  if (!has_frame_) return;
  if (keyframes_.size() < most_keyframes)
    keyframes_.emplace_back(keyframe, frame_);
  else
    keyframes_[next_] = {keyframe, frame_};
  next_ = (next_ + 1) % most_keyframes;
}

const Matrix6d* PoseCovariance::find(KeyFrameId keyframe) const {
  const auto found =
      std::find_if(keyframes_.begin(), keyframes_.end(), [&](const auto& k) { return k.first == keyframe; });
  return keyframe.valid() && found != keyframes_.end() ? &found->second : nullptr;
}

}  // namespace holdfast
