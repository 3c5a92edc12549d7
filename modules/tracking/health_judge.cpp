// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/health_judge.hpp"

#include <Eigen/Eigenvalues>

namespace holdfast {

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

FrameHealth HealthJudge::judge(const FrameResult& result, TrackerState state, const std::function<bool()>& hides_most) {
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
    if (hides_most()) health.reasons.add(HealthReason::hidden_view);
  }
  corrected_.reset();
  covariance_ = result.covariance;
  was_lost_ = health.state == HealthState::lost;
  return health;
}

}  // namespace holdfast
