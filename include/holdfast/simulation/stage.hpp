// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

namespace holdfast::simulation {

/// A camera path through the room: positions and viewing direction.
struct Waypoints {
  std::vector<Eigen::Vector3d> places;  ///< of the camera [m]; at least two, three if closed
  bool closed = true;                   ///< repeated loop; otherwise to the last position, a turn, and back
  double speed = 0.65;                  ///< [m/s]; slow walking
  double rounding = 0.8;                ///< corners are rounded over about this distance before and after them [m]
  /// The camera looks at this point; if it is absent, along the path, rotated as given below.
  std::optional<Eigen::Vector3d> target;
  double aside = 0.0;   ///< viewing direction to the left of the path [rad]; to the right on the way back
  double glance = 0.0;  ///< amplitude of the oscillation of the viewing direction [rad]
  double down = 0.2;    ///< viewing direction below the horizon [rad]
};

/// Positions in a room to which camera paths and scenes refer, in the room's frame (z up, floor at z = 0) [m].
struct Stage {
  Eigen::AlignedBox3d walls;       ///< from wall to wall, floor to ceiling
  Eigen::AlignedBox2d free_floor;  ///< where people walk and objects are pushed; contains only rugs and `table`
  Eigen::Vector3d home;            ///< position of the camera of static, xyz and rpy
  Eigen::Vector3d target;          ///< its viewing target, in direction +y of home; the centre of halfsphere

  /// Range of halfsphere: each value oscillates around its mean with the amplitude `_swing`.
  struct HalfSphere {
    double radius = 1.7, radius_swing = 0.1;          ///< from the target [m]
    double azimuth_swing = 0.85;                      ///< about the direction to home [rad]
    double elevation = 0.62, elevation_swing = 0.38;  ///< [rad]
  };
  HalfSphere half_sphere;

  /// The table of the paper's experiments, parallel to the walls.
  struct Table {
    Eigen::Vector2d centre;
    Eigen::Vector2d size;  ///< along x and y
    double height = 0.0;   ///< of its top
  };
  Table table;
  Eigen::Vector3d table_edge;         ///< mean camera position of the motion along the table's edge, parallel to x
  Eigen::Vector3d table_edge_target;  ///< its viewing target
  Eigen::Vector3d spot;               ///< the axis of a rotation on the spot

  Waypoints loop, corridor, square;
};

}  // namespace holdfast::simulation
