// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/simulation/stage.hpp"
#include "holdfast/simulation/waypoint_path.hpp"

namespace holdfast::simulation {

/// How the camera moves. After the names of the TUM fr3 sequences (Sturm et al., IROS 2012): fixed: held by hand
/// without moving; xyz: along three axes, looking the same way; halfsphere: on a half sphere around a desk; rpy:
/// turning about all axes at one place. Walks: loop: around the room, lap after lap; corridor: along a row of desks, to
/// the end and back. After the experiments of Zeng et al. (Remote Sens. 2023, 15, 5479): table_edge: 7.5 cm along a
/// table's edge and back; rotation: full turns on the spot; square: a square around a table, looking at it. waypoints:
/// along places that the caller names.
enum class PathKind { fixed, xyz, halfsphere, rpy, loop, corridor, table_edge, rotation, square, waypoints };

/// "static", "xyz", "halfsphere", "rpy", "loop", "corridor", "table_edge", "rotation", "square", "waypoints".
const char* to_string(PathKind kind);
/// The kind of that name; throws ConfigurationError naming the known ones.
PathKind path_kind(const std::string& name);
/// The names of all kinds; those that a stage alone defines: all but "waypoints", which comes last.
std::vector<std::string> path_names(bool of_stage_alone = true);

/// Factors on a camera path.
struct PathStyle {
  double speed = 1.0;  ///< of the motion; the hand trembles at its own pace
  double shake = 1.0;  ///< of the hand's tremor and the walker's bob; 0 = none
};

/// The camera's pose as a smooth function of time: what a hand does, with a slight tremor, and a walker's bob where
/// somebody walks. Starts at speed zero, reaches its speed after a second, goes on for ever. The seed changes phases
/// and tremor, not the kind of motion.
class CameraPath {
 public:
  /// A path of any kind but PathKind::waypoints, at the places of a stage.
  CameraPath(PathKind kind, const Stage& stage, std::uint64_t seed, const PathStyle& style = {});
  /// PathKind::waypoints; throws ConfigurationError as WaypointPath does.
  CameraPath(const Waypoints& waypoints, std::uint64_t seed, const PathStyle& style = {});

  /// T_world_camera at a time >= 0 [s]; camera frame x right, y down, z forward; world z up.
  Eigen::Isometry3d pose(double time) const;
  /// Time of one round [s]: back at the start, at the same heading. Of the hand's motions, which never come back to
  /// the same pose (static, xyz, halfsphere, rpy): the time in which they have shown what they do.
  double cycle() const;
  PathKind kind() const { return kind_; }

 private:
  struct Tremor {
    double amplitude, frequency, phase;
  };
  CameraPath(PathKind kind, const Stage& stage, std::optional<WaypointPath> walk, std::uint64_t seed,
             const PathStyle& style);
  Eigen::Isometry3d hand_pose(double time) const;
  Eigen::Isometry3d walk_pose(double time) const;

  PathKind kind_;
  Stage stage_;
  PathStyle style_;
  std::optional<WaypointPath> walk_;
  double phases_[6];
  std::vector<Tremor> tremors_[6];  // three of position [m], three of rotation [rad]
};

/// T_world_camera of a camera at `eye` that looks at `target` with the horizon level.
Eigen::Isometry3d look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target);

}  // namespace holdfast::simulation
