// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

namespace holdfast::simulation {

/// A way through the room in words: past some places, with a look.
struct Waypoints {
  std::vector<Eigen::Vector3d> places;  ///< of the camera [m]; at least two, three if closed
  bool closed = true;                   ///< round and round; otherwise to the last place, turning there, and back
  double speed = 0.65;                  ///< [m/s]; a stroll
  double rounding = 0.8;                ///< corners are rounded from about this far before to this far behind them [m]
  /// Looks at this point all the time; otherwise along the way, turned aside as given below.
  std::optional<Eigen::Vector3d> target;
  double aside = 0.0;   ///< gaze turned to the left of the way [rad]; on the way back to the right: to the same things
  double glance = 0.0;  ///< gaze swings by this much to either side of that [rad]
  double down = 0.2;    ///< gaze lowered [rad]
};

/// Places of a room that camera paths and scenes refer to, in the room's frame (z up, floor at z = 0) [m].
struct Stage {
  Eigen::AlignedBox3d walls;       ///< from wall to wall, floor to ceiling
  Eigen::AlignedBox2d free_floor;  ///< where people may walk and things be pushed: nothing but rugs and `table` there
  Eigen::Vector3d home;            ///< where the camera of static, xyz and rpy is held
  Eigen::Vector3d target;          ///< what it looks at, to +y of home; the middle of halfsphere

  /// Where halfsphere goes: each swings by its second number to either side of its first.
  struct HalfSphere {
    double radius = 1.7, radius_swing = 0.1;          ///< from the target [m]
    double azimuth_swing = 0.85;                      ///< about the direction to home [rad]
    double elevation = 0.62, elevation_swing = 0.38;  ///< [rad]
  };
  HalfSphere half_sphere;

  /// The table of the paper's experiments, square to the walls.
  struct Table {
    Eigen::Vector2d centre;
    Eigen::Vector2d size;  ///< along x and y
    double height = 0.0;   ///< of its top
  };
  Table table;
  Eigen::Vector3d table_edge;         ///< the camera's middle when it slides along the table's edge, parallel to x
  Eigen::Vector3d table_edge_target;  ///< what it looks at from there
  Eigen::Vector3d spot;               ///< the axis of a rotation on the spot

  Waypoints loop, corridor, square;
};

}  // namespace holdfast::simulation
