// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "holdfast/simulation/skeleton.hpp"

namespace holdfast::simulation {

/// A foot at a moment, in the world.
struct FootPose {
  Eigen::Vector3d ankle;
  double heading = 0.0;  ///< [rad]
  double pitch = 0.0;    ///< toes down positive [rad]
  bool planted = true;   ///< heel, sole or toes rest on the floor

  Eigen::Quaterniond rotation() const;
};

/// Where one foot stands and when. While it stands it does not slide: it lands on the heel, rolls to the flat sole and
/// leaves over the tip of the toes; the ankle follows from the roll. Between two stands it swings along a cubic curve
/// that takes up the speeds at both ends, so the ankle's path is C1.
class FootTrack {
 public:
  FootTrack(const Skeleton& skeleton, const Eigen::Vector2d& position, double heading);

  /// How a foot lands, and how it had left.
  struct Step {
    double lifted = 0.0, landed = 0.0;  ///< [s]
    Eigen::Vector2d position;           ///< of the ankle when the sole is flat
    double heading = 0.0;
    double push = 0.0;    ///< roll over the toes when leaving [rad]
    double strike = 0.0;  ///< toes up when landing [rad]
    double lift = 0.0;    ///< additional height in the middle of the swing [m]
  };
  /// Adds a step; must begin at or after the last one's landing.
  void step(const Step& step);

  FootPose pose(double time) const;
  /// Where it stands in the end.
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
