// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "holdfast/simulation/room.hpp"

namespace holdfast::simulation {

/// street: a lane in each direction, parked cars, trees, lamps and houses on both sides. motorway: two lanes in each
/// direction, guard rails, lorries, and grass with trees, signs, noise barriers and bridges.
enum class RoadKind { street, motorway };

/// "street", "motorway".
const char* to_string(RoadKind kind);
std::vector<std::string> road_names();
/// The kind of that name; throws ConfigurationError naming the known ones.
RoadKind road_kind(const std::string& name);

/// A road on which a car with the camera drives. Traffic keeps to the right.
struct RoadPlan {
  RoadKind kind = RoadKind::street;
  double speed = 0.0;    ///< mean speed of the camera [m/s]; 0 = 10 in a street, 25 on a motorway
  double traffic = 1.0;  ///< factor on the density of moving vehicles; 0 = none
  double bends = 1.0;    ///< factor on the curvature; 0 = straight

  double mean_speed() const { return speed > 0.0 ? speed : kind == RoadKind::street ? 10.0 : 25.0; }
};

/// Widths of the parts of a road, on either side of its centre line [m].
struct RoadProfile {
  std::vector<double> lanes;  ///< centres of the lanes of one direction, from the centre line outwards
  double lane_width;
  double edge;   ///< of the asphalt
  double verge;  ///< beginning of gardens or grass
};
const RoadProfile& road_profile(RoadKind kind);

/// Centre line of a road and the motion of the camera's car along it. The line is y = c(x) in the world frame (x ahead,
/// y left, z up) with a sum of two sine waves c. Deterministic for a seed.
class RoadCourse {
 public:
  RoadCourse(const RoadPlan& plan, std::uint64_t seed);

  /// T_world_road at the abscissa x: x along the road, y to its left, z up; the origin is `left` [m] of the centre
  /// line.
  Eigen::Isometry3d frame(double x, double left = 0.0) const;
  /// Abscissa of the camera at a time [s]: 0 at the time 0, where it already moves; the speed varies by 8 %.
  double driven(double time) const;
  /// Offset of the camera's lane to the left of the centre line [m], thus negative.
  double lane() const;

 private:
  struct Wave {
    double amplitude, frequency, phase;
  };
  RoadPlan plan_;
  Wave waves_[2];
  double phase_;  // of the speed
};

/// Creates a road without baked light, long enough for a drive of `duration` [s], with its traffic in motion. Stretches
/// depend on seed and position only: a longer duration leaves them unchanged.
/// \throws ConfigurationError if the drive is longer than 20 km.
Room furnish_road(const RoadPlan& plan, double duration, std::uint64_t seed);

}  // namespace holdfast::simulation
