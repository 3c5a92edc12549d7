// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "holdfast/simulation/skeleton.hpp"

namespace holdfast::simulation {

/// Pose of a foot at one time, in the world.
struct FootPose {
  Eigen::Vector3d ankle;
  double heading = 0.0;  ///< [rad]
  double pitch = 0.0;    ///< positive with toes down [rad]
  bool planted = true;   ///< whether heel, sole or toes touch the floor

  Eigen::Quaterniond rotation() const;
};

/// The footholds of one foot over time. A planted foot does not slide: it lands on the heel, rolls to the flat sole and
/// leaves over the toes, and the ankle follows from the roll. Between two footholds it moves along a cubic curve with
/// matching velocities at both ends, so that the path of the ankle is C1.
class FootTrack {
 public:
  FootTrack(const Skeleton& skeleton, const Eigen::Vector2d& position, double heading);

  /// A step: how the foot leaves the floor and how it lands.
  struct Step {
    double lifted = 0.0, landed = 0.0;  ///< [s]
    Eigen::Vector2d position;           ///< of the ankle when the sole is flat
    double heading = 0.0;
    double push = 0.0;    ///< roll over the toes when leaving [rad]
    double strike = 0.0;  ///< toes up when landing [rad]
    double lift = 0.0;    ///< additional height half way through the swing [m]
  };
  /// Adds a step, which must begin at or after the landing of the last one.
  void step(const Step& step);

  FootPose pose(double time) const;
  /// Final position of the foot.
  const Eigen::Vector2d& position() const { return stands_.back().position; }

 private:
  struct Stand {
    double from, to;
    Eigen::Vector2d position;
    double heading, strike, push, lift;
  };
  FootPose standing(const Stand& stand, double time) const;

  double toe_, heel_, ankle_height_;
  std::vector<Stand> stands_;
};

}  // namespace holdfast::simulation
