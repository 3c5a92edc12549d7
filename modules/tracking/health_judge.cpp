// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/health_judge.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace holdfast {

namespace {

/// Sum of the squared weighted residuals of the inliers by their degrees of freedom. Disparities have the noise and the
/// robust cost of adjust_pose().
double variance_factor(const PoseProblem& problem) {
  constexpr double least = 0.01;  // noise of 0.1 px: smaller residuals are chance or synthetic
  const auto camera = problem.camera->pinhole();
  double sum = 0.0;
  int residuals = 0;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    if (problem.inlier[i] == 0 || !(problem.weight[i] > 0.0F)) continue;
    const Eigen::Vector3d point = problem.T_camera_world * problem.points[i];
    const double x = camera.fx * point.x() / point.z() + camera.cx - problem.x[i];
    const double y = camera.fy * point.y() / point.z() + camera.cy - problem.y[i];
    double squares = problem.inverse_sigma2[i] * (x * x + y * y);
    residuals += 2;
    if (!std::isnan(problem.right_x[i])) {
      const double measured = static_cast<double>(problem.x[i]) - problem.right_x[i];
      const double deviations =
          std::abs(camera.fx * camera.baseline / point.z() - measured) / geometry::disparity_sigma;
      squares += deviations * std::min(deviations, geometry::disparity_threshold);
      ++residuals;
    }
    sum += problem.weight[i] * squares;
  }
  return std::max(least, sum / std::max(1, residuals - 6));
}

bool hides_much(const CoarseView& view) {
  const auto cells = static_cast<std::size_t>(view.grid.size());
  std::size_t hidden = 0;
  for (std::size_t i = 0; i < cells; ++i) {
    const bool is_movable = i < view.mask.labels.size() && CellMask::is_object(view.mask.labels[i]);
    hidden += is_movable || (i < view.static_log_odds.size() && view.static_log_odds[i] < 0.0F) ? 1 : 0;
  }
  return cells > 0 && 2 * hidden > cells;
}

}  // namespace

Eigen::Matrix<double, 6, 6> calibrated_covariance(const PoseProblem& problem,
                                                  const Eigen::Matrix<double, 6, 6>& covariance) {
  return correlation_factor * variance_factor(problem) * covariance;
}

HealthReasons HealthJudge::find_reasons(const FrameResult& result, TrackerState state) const {
  HealthReasons reasons;
  if (result.status == TrackingStatus::initialised) {
    if (reported_) reasons.add(HealthReason::new_map);
    return reasons;
  }
  if (result.fallback != TrackingFallback::none) reasons.add(HealthReason::fallback);
  if (state == TrackerState::unconfirmed) reasons.add(HealthReason::unconfirmed);
  if (result.inliers < minimum_inliers_) reasons.add(HealthReason::few_inliers);
  if (result.covariance) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(result.covariance->topLeftCorner<3, 3>(),
                                                              Eigen::EigenvaluesOnly);
    if (!(axes.eigenvalues().maxCoeff() <= largest_deviation_ * largest_deviation_))
      reasons.add(HealthReason::poor_geometry);
  }
  return reasons;
}

double HealthJudge::correction() const {
  return reported_ && corrected_ ? (corrected_->translation() - reported_->translation()).norm() : 0.0;
}

FrameHealth HealthJudge::judge(const FrameResult& result, TrackerState state, const CoarseView& view) {
  FrameHealth health;
  if (!result.T_world_camera) {
    health.state = state == TrackerState::waiting ? HealthState::waiting : HealthState::lost;
  } else {
    health.reasons = find_reasons(result, state);
    const bool has_jumped = was_lost_ || health.reasons.has(HealthReason::new_map) || correction() > largest_correction;
    if (has_jumped) {
      health.state = HealthState::relocalised;
      health.jump = !reported_ ? 0.0
                    : was_lost_ || health.reasons.has(HealthReason::new_map)
                        ? (result.T_world_camera->translation() - reported_->translation()).norm()
                        : correction();
    } else {
      health.state = result.status == TrackingStatus::inertial ? HealthState::inertial
                     : health.reasons.empty()                  ? HealthState::good
                                                               : HealthState::degraded;
    }
    reported_ = result.T_world_camera;
  }
  if (health.state != HealthState::good && health.state != HealthState::waiting) {
    if (result.static_features < 4 * minimum_inliers_ && result.features < 8 * minimum_inliers_)
      health.reasons.add(HealthReason::few_features);
    if (hides_much(view)) health.reasons.add(HealthReason::hidden_view);
  }
  corrected_.reset();
  covariance_ = result.covariance;
  was_lost_ = health.state == HealthState::lost;
  return health;
}

}  // namespace holdfast
