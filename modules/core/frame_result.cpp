// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/frame_result.hpp"

namespace holdfast {

const char* to_string(TrackingStatus status) {
  switch (status) {
    case TrackingStatus::waiting:
      return "waiting";
    case TrackingStatus::initialised:
      return "initialised";
    case TrackingStatus::tracked:
      return "tracked";
    case TrackingStatus::lost:
      return "lost";
    case TrackingStatus::inertial:
      return "inertial";
  }
  return "?";
}

const char* to_string(TrackingMethod method) {
  switch (method) {
    case TrackingMethod::none:
      return "none";
    case TrackingMethod::motion_model:
      return "motion model";
    case TrackingMethod::reference_keyframe:
      return "reference keyframe";
    case TrackingMethod::recovered:
      return "recovered";
    case TrackingMethod::relocalised:
      return "relocalised";
    case TrackingMethod::flow:
      return "flow";
  }
  return "?";
}

const char* to_string(TrackingFallback fallback) {
  switch (fallback) {
    case TrackingFallback::none:
      return "none";
    case TrackingFallback::odometry:
      return "odometry";
    case TrackingFallback::masked_features:
      return "masked features";
    case TrackingFallback::dense_depth:
      return "dense depth";
    case TrackingFallback::inertial:
      return "inertial";
  }
  return "?";
}

const char* to_string(TrackingFailure failure) {
  switch (failure) {
    case TrackingFailure::none:
      return "none";
    case TrackingFailure::no_depth:
      return "no depth";
    case TrackingFailure::few_features:
      return "too few features";
    case TrackingFailure::few_matches:
      return "too few matches";
    case TrackingFailure::few_inliers:
      return "too few inliers";
    case TrackingFailure::little_parallax:
      return "too little parallax";
    case TrackingFailure::no_mask:
      return "no mask yet";
    case TrackingFailure::weak_start:
      return "weak start";
    case TrackingFailure::exchanged_pair:
      return "left and right exchanged";
  }
  return "?";
}

const char* to_string(HealthState state) {
  switch (state) {
    case HealthState::waiting:
      return "waiting";
    case HealthState::good:
      return "good";
    case HealthState::degraded:
      return "degraded";
    case HealthState::inertial:
      return "inertial";
    case HealthState::relocalised:
      return "relocalised";
    case HealthState::lost:
      return "lost";
    case HealthState::stalled:
      return "stalled";
  }
  return "?";
}

const char* to_string(HealthReason reason) {
  switch (reason) {
    case HealthReason::few_inliers:
      return "few inliers";
    case HealthReason::poor_geometry:
      return "poor geometry";
    case HealthReason::fallback:
      return "fallback";
    case HealthReason::unconfirmed:
      return "unconfirmed";
    case HealthReason::new_map:
      return "new map";
    case HealthReason::few_features:
      return "few features";
    case HealthReason::hidden_view:
      return "hidden view";
  }
  return "?";
}

}  // namespace holdfast
