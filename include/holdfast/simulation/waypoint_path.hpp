// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "holdfast/simulation/stage.hpp"

namespace holdfast::simulation {

/// A camera path along Waypoints. The polyline is smoothed by two moving averages over `rounding`, so that the position
/// is a twice differentiable function of the travelled distance inside the corners of the polyline; the viewing
/// direction is that of the polyline, smoothed by two further moving averages.
class WaypointPath {
 public:
  /// Throws ConfigurationError for too few positions, coinciding positions, or a speed that is not positive.
  explicit WaypointPath(const Waypoints& waypoints);

  /// Length of the smoothed path in one direction [m].
  double length() const { return length_; }
  /// Duration of one loop, or of the path to the end and back with both turns [s].
  double cycle() const;
  /// Travelled distance at a time >= 0 [m]. The speed of a closed path is constant; an open one stops at its ends.
  double walked(double time) const;
  /// T_world_camera at a time >= 0 [s], without roll.
  Eigen::Isometry3d pose(double time) const;

 private:
  struct Moment {
    double distance;  // along the line from its first place [m]
    double turned;    // 0: looking along the way there; 1: along the way back
  };
  /// Samples the rounded line at equal distances.
  void resample(const std::vector<Eigen::Vector3d>& points);
  void find_headings();
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
