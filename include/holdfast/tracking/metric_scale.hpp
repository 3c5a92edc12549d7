// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <optional>

#include "holdfast/tracking/inertial_smoothing.hpp"

namespace holdfast {

/// Scale of one camera's map by all inertial measurements of a run.
struct ScaleEstimate {
  double scale = 1.0;      ///< metres in a unit of the map
  double deviation = 0.0;  ///< relative standard deviation of the scale
  /// In the world frame [m/s^2], of the chain of frames that determines the scale best.
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();
};

/// Estimates the scale of the trajectory as a further unknown of the problem of smooth_by_inertia(), with measurements
/// weighted by their noise; the map and the poses stay. All frames count, because much of the acceleration of a hand is
/// too fast for keyframes. The poses must not be smoothed: a smoothed path has smaller accelerations, and too large a
/// scale. The standard deviation is that of the profile of the cost; it grows with the root of the mean squared
/// residual if that is larger than 1. Several chains of frames are weighted by their information; errors of the IMU's
/// model are common to them, and one camera's scale may drift, so that the result is at most twice as certain as the
/// best one, and less certain where they disagree. `estimates`: initial values. Empty if there is no chain.
std::optional<ScaleEstimate> estimate_scale(const RunPath& path, const UnplacedFrames& unplaced,
                                            const InertialHistory& inertia, const MapInertia& estimates,
                                            Optimizer& optimizer, const std::atomic<bool>& stop);

/// Gravity, biases, calibration and scale of one camera's map by the measurements of the whole run, at its end: first
/// estimates are those of tracking (`tracked`), or else an inertial start (find_inertial_start) on up to 20 s of
/// the trajectory; then estimate_scale() gives the scale and gravity. The trajectory must not be smoothed. Empty if it
/// has no 5 s that measurements link, or if the scale has a standard deviation of more than 1 %.
std::optional<MapInertia> estimate_metres(const RunPath& path, const UnplacedFrames& unplaced,
                                          const InertialHistory& inertia, const std::optional<MapInertia>& tracked,
                                          Optimizer& optimizer, const std::atomic<bool>& stop);

}  // namespace holdfast
