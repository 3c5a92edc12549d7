// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/interfaces/bundle_selection.hpp"

#include <cmath>
#include <limits>

#include "holdfast/core/check.hpp"

namespace holdfast {

namespace {

bool is_finite(const BundleProblem::Observation& observation) {
  return std::isfinite(observation.x) && std::isfinite(observation.y) && !std::isinf(observation.right_x) &&
         std::isfinite(observation.inverse_sigma2) && std::isfinite(observation.weight) &&
         observation.inverse_sigma2 > 0.0f;
}

}  // namespace

double ChiSquareLimits::of(const BundleProblem::Observation& observation) const {
  return std::isnan(observation.right_x) ? two : three;
}

double chi_square(const Camera& camera, const Eigen::Isometry3d& T_camera_world, const Eigen::Vector3d& point,
                  const BundleProblem::Observation& observation) {
  const Eigen::Vector3d p = T_camera_world.linear() * point + T_camera_world.translation();
  if (!(p.z() > geometry::minimum_depth)) return std::numeric_limits<double>::infinity();
  const Eigen::Vector2d pixel = camera.project(p);
  double squared = (pixel - Eigen::Vector2d(observation.x, observation.y)).squaredNorm();
  if (!std::isnan(observation.right_x)) {
    const double right = camera.right_x(pixel.x(), p.z()) - observation.right_x;
    squared += right * right;
  }
  return squared * observation.inverse_sigma2;
}

bool is_outlier(const Camera& camera, const Eigen::Isometry3d& T_camera_world, const Eigen::Vector3d& point,
                const BundleProblem::Observation& observation, const ChiSquareLimits& limits) {
  return !is_finite(observation) || !(chi_square(camera, T_camera_world, point, observation) <= limits.of(observation));
}

void BundleSelection::select(const BundleProblem& problem) {
  HOLDFAST_CHECK(problem.camera != nullptr, "a bundle problem needs a camera");
  const std::size_t count = problem.observations.size();
  observation_counts.assign(count, 0);
  point_counts.assign(problem.points.size(), 0);
  pose_moves.assign(problem.poses.size(), 0);
  rows_.assign(problem.points.size(), 0);
  for (std::size_t i = 0; i < count; ++i) {
    const BundleProblem::Observation& observation = problem.observations[i];
    HOLDFAST_CHECK(observation.pose < problem.poses.size() && observation.point < problem.points.size(),
                   "observation " << i << " pose " << observation.pose << " of " << problem.poses.size() << " point "
                                  << observation.point << " of " << problem.points.size());
    if (!is_finite(observation) || observation.weight <= 0.0f) continue;
    const BundleProblem::Pose& pose = problem.poses[observation.pose];
    const double squared =
        chi_square(*problem.camera, pose.T_camera_world, problem.points[observation.point], observation);
    if (!std::isfinite(squared)) continue;
    observation_counts[i] = 1;
    rows_[observation.point] += std::isnan(observation.right_x) ? 2 : 3;
    if (!pose.fixed) point_counts[observation.point] = 1;
  }
  for (std::size_t i = 0; i < rows_.size(); ++i) point_counts[i] = point_counts[i] && rows_[i] >= 3;
  for (std::size_t i = 0; i < count; ++i) {
    const BundleProblem::Observation& observation = problem.observations[i];
    observation_counts[i] = observation_counts[i] && point_counts[observation.point];
    if (observation_counts[i] && !problem.poses[observation.pose].fixed) pose_moves[observation.pose] = 1;
  }
  if (!problem.factors.empty()) select_by_factors(problem);
}

void BundleSelection::select_by_factors(const BundleProblem& problem) {
  const FactorEvaluation evaluation(problem);
  for (const FactorEvaluation::Factor& factor : evaluation.factors())
    for (const std::uint32_t pose : factor.poses)
      if (pose != FactorEvaluation::none && !problem.poses[pose].fixed) pose_moves[pose] = 1;
}

}  // namespace holdfast
