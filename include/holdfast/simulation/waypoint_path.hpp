// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "holdfast/simulation/stage.hpp"

namespace holdfast::simulation {

/// A walk along Waypoints. The broken line is rounded by two moving averages over `rounding`, which makes position a
/// twice differentiable function of the distance walked that keeps inside the line's corners; the gaze follows the
/// line's direction through two more.
class WaypointPath {
 public:
  /// Throws ConfigurationError for too few places, places that coincide, or a speed that is not positive.
  explicit WaypointPath(const Waypoints& waypoints);

  /// Of the rounded line, one way [m].
  double length() const { return length_; }
  /// Time of one round, or of the way to the end and back with both turns [s].
  double cycle() const;
  /// Distance walked until a time >= 0 [m]. A closed path goes at constant speed; an open one stops at its ends.
  double walked(double time) const;
  /// T_world_camera at a time >= 0 [s], horizon level.
  Eigen::Isometry3d pose(double time) const;

 private:
  struct Moment {
    double distance;  // along the line from its first place [m]
    double turned;    // 0: looking along the way there; 1: along the way back
  };
  Moment moment(double time) const;
  Eigen::Vector3d position(double distance) const;
  double heading(double distance) const;

  Waypoints waypoints_;
  double length_ = 0.0;
  double step_ = 0.0;                       // between samples [m]
  double winding_ = 0.0;                    // change of heading per round of a closed path [rad]
  std::vector<Eigen::Vector3d> positions_;  // at equal distances
  std::vector<double> headings_;            // at the same, without jumps [rad]
};

/// T_world_camera of a camera at `eye` that looks to `heading` (about z, 0 = +x) and `down` below the horizon [rad].
Eigen::Isometry3d look_along(const Eigen::Vector3d& eye, double heading, double down);

}  // namespace holdfast::simulation
