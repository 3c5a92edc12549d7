// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "holdfast/core/imu.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/geometry/inertial_start.hpp"

namespace holdfast {

/// Standard deviations of given calibrations: rotation of T_body_camera per axis [rad], time offset [s].
inline constexpr double nominal_mounting_deviation = 0.015, nominal_time_offset_deviation = 0.005;

/// Standard deviations of poses, per axis: position [m], rotation [rad].
struct PoseDeviations {
  double position = 0.0, rotation = 0.0;
};

/// Settings of find_inertial_start().
struct InertialStartSearch {
  bool estimate_scale = false;
  /// Standard deviations of positions that are tried: the first and the last of 1, 2, 5, 10 and 20 mm [m].
  double smallest_deviation = 0.002, largest_deviation = 0.01;
  /// Standard deviations of a start that is found, at most (geometry::InertialStartOptions).
  double largest_direction_deviation = geometry::InertialStartOptions().largest_direction_deviation;
  double largest_scale_deviation = geometry::InertialStartOptions().largest_scale_deviation;
  double largest_velocity_deviation = geometry::InertialStartOptions().largest_velocity_deviation;
};

/// An inertial start, and what it was found from.
struct FoundInertialStart {
  geometry::InertialStart start;
  Trajectory poses;
  std::vector<geometry::Preintegration> motions;  ///< from each pose to the next, integrated at about the biases found
  std::vector<Eigen::Vector3d> rates;             ///< measured at each pose [rad/s]
  PoseDeviations deviations;                      ///< of the poses, which explain their residuals
};

/// Starts inertial estimation from tracked poses (geometry::start_inertially). How exact the poses are is unknown:
/// standard deviations are tried in increasing order. The first ones that explain the residuals, with a usable result,
/// are taken, times the root of the mean squared residual if that is larger than 1. Motions depend on the biases
/// linearly between poses that are close in time only: elsewhere they are integrated anew at the biases found. Empty
/// without a usable result, and where measurements are missing. `samples`: increasing time stamps.
std::optional<FoundInertialStart> find_inertial_start(const Trajectory& poses, std::span<const ImuSample> samples,
                                                      const ImuCalibration& imu, const InertialStartSearch& search);

/// The angular velocity measured at a time that the samples cover, or else the nearest one [rad/s]. `samples`: at least
/// one, with increasing time stamps.
Eigen::Vector3d rate_at(std::span<const ImuSample> samples, double time);

}  // namespace holdfast
