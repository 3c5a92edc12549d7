// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <optional>

#include "holdfast/core/frame_result.hpp"
#include "holdfast/tracking/tracker_state.hpp"
#include "holdfast/tracking/tracking_settings.hpp"

namespace holdfast {

/// Derives the health of frames from their results, one after the other. One thread.
///
/// A pose is degraded if the map did not determine it (a fallback), if it is unconfirmed, if fewer inliers agree than
/// 4/3 of TrackingSettings::minimum_inliers, or if the largest standard deviation of its position exceeds half of
/// TrackingSettings::maximum_deviation. It is relocalised if the frame before had none, or if corrections moved the map
/// under the camera by more than `largest_correction`.
class HealthJudge {
 public:
  static constexpr double largest_correction = 0.05;  ///< in the unit of the map

  explicit HealthJudge(const TrackingSettings& settings)
      : minimum_inliers_(settings.minimum_inliers * 4 / 3), largest_deviation_(0.5 * settings.maximum_deviation) {}

  /// The map as it is now places the last frame that had a pose here.
  void follow_map(const Eigen::Isometry3d& T_world_camera) { corrected_ = T_world_camera; }
  /// `result` is complete but for its health; `hides_most` is MovingWorld::hides_most() of its view, called
  /// where the health is to be explained.
  FrameHealth judge(const FrameResult& result, TrackerState state, const std::function<bool()>& hides_most);
  /// The pose of the last frame was refined before it was reported.
  void refined(const Eigen::Isometry3d& T_world_camera) { reported_ = T_world_camera; }
  /// Covariance of the frame before, if it had one.
  const std::optional<Eigen::Matrix<double, 6, 6>>& last_covariance() const { return covariance_; }
  /// The map was removed.
  void forget_map() { reported_.reset(), corrected_.reset(), covariance_.reset(), was_lost_ = false; }

 private:
  HealthReasons find_reasons(const FrameResult& result, TrackerState state) const;
  double correction() const;

  int minimum_inliers_;
  double largest_deviation_;
  std::optional<Eigen::Isometry3d> reported_, corrected_;  // the last pose, as reported and by the map since
  std::optional<Eigen::Matrix<double, 6, 6>> covariance_;
  bool was_lost_ = false;
};

}  // namespace holdfast
