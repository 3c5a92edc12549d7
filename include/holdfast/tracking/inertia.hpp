// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>

#include "holdfast/geometry/se3.hpp"
#include "holdfast/tracking/tracking_settings.hpp"

namespace holdfast {

/// Whether a pose contradicts the inertia of the camera, that is, deviates too far from the constant-velocity
/// prediction. `change` is the deviation T_camera_predicted after `interval` seconds. The limit is `factor` times
/// TrackingSettings::jump_distance and jump_angle for each 1/30 s of the interval, which counts as 1/30 s at least.
inline bool contradicts_inertia(const Eigen::Isometry3d& change, double interval, const TrackingSettings& settings,
                                double factor = 1.0) {
  constexpr double frame_interval = 1.0 / 30.0;  // s
  const double frames = factor * std::max(1.0, interval / frame_interval);
  return geometry::exceeds(change, settings.jump_distance * frames,
                           settings.jump_angle * std::numbers::pi / 180.0 * frames);
}

}  // namespace holdfast
