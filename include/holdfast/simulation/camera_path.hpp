// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/core/random.hpp"
#include "holdfast/simulation/road.hpp"
#include "holdfast/simulation/stage.hpp"
#include "holdfast/simulation/waypoint_path.hpp"

namespace holdfast::simulation {

/// Kind of camera motion. As in the TUM fr3 sequences (Sturm et al., IROS 2012): fixed: hand-held without motion; xyz:
/// along three axes with constant orientation; halfsphere: on a half sphere around a desk; rpy: rotation about all axes
/// at one position. Walks: loop: around the room, repeatedly; corridor: along a row of desks to the end and back. As in
/// the experiments of Zeng et al. (Remote Sens. 2023, 15, 5479): table_edge: 7.5 cm along the edge of a table and back;
/// rotation: full rotations on the spot; square: a square around a table, looking at it. waypoints: along given
/// positions. drive: in a car along a road.
enum class PathKind { fixed, xyz, halfsphere, rpy, loop, corridor, table_edge, rotation, square, waypoints, drive };

/// "static", "xyz", "halfsphere", "rpy", "loop", "corridor", "table_edge", "rotation", "square", "waypoints", "drive".
const char* to_string(PathKind kind);
/// The kind of that name, except "drive"; throws ConfigurationError naming the known ones.
PathKind path_kind(const std::string& name);
/// The names of all kinds but "drive", which belongs to every road. With `of_stage_alone`, "waypoints" is excluded,
/// because it needs more than a stage; otherwise it is the last one.
std::vector<std::string> path_names(bool of_stage_alone = true);

/// A turn of the camera about the vertical through its centre, on top of its path.
struct Turn {
  double begin = 0.0;  ///< [s]
  double angle = 0.0;  ///< to the left; below 0 to the right [rad]
  double rate = 1.0;   ///< the largest one, which the smooth turn has at half its angle [rad/s]
};

/// Changes of a camera path.
struct PathStyle {
  double speed = 1.0;  ///< factor on the motion; the frequency of the tremor is independent
  double shake = 1.0;  ///< factor on the hand's tremor and the vertical motion of walking; 0 = none
  std::vector<Turn> turns = {};
};

/// The camera pose as a smooth function of time, with the tremor of a hand and, for walks, the vertical motion of
/// walking, or with the vibrations of a car. It starts at rest, reaches its speed after one second and never ends; a
/// drive has its speed from the beginning. The seed changes phases and tremor, not the kind of motion.
class CameraPath {
 public:
  /// A path of any kind except PathKind::waypoints and PathKind::drive, at the positions of a stage.
  CameraPath(PathKind kind, const Stage& stage, std::uint64_t seed, const PathStyle& style = {});
  /// PathKind::waypoints; throws ConfigurationError as WaypointPath does.
  CameraPath(const Waypoints& waypoints, std::uint64_t seed, const PathStyle& style = {});

  /// PathKind::drive: in the right lane of a road with the same seed, 1.65 m above it.
  CameraPath(const RoadPlan& road, std::uint64_t seed, const PathStyle& style = {});

  /// T_world_camera at a time >= 0 [s]; camera frame x right, y down, z forward; world z up.
  Eigen::Isometry3d pose(double time) const;
  /// Period of the path [s], after which position and heading are those of the start. For the hand-held motions, which
  /// never return exactly (static, xyz, halfsphere, rpy), a duration that covers their range.
  double cycle() const;
  PathKind kind() const { return kind_; }

 private:
  struct Tremor {
    double amplitude, frequency, phase;
  };
  CameraPath(PathKind kind, const Stage& stage, std::optional<WaypointPath> walk, std::uint64_t seed,
             const PathStyle& style);
  void add_tremor(double position, double rotation, double frequency, double factor, Random random);
  Eigen::Isometry3d drive_pose(double time) const;
  Eigen::Isometry3d hand_pose(double time) const;
  Eigen::Isometry3d walk_pose(double time) const;

  PathKind kind_;
  Stage stage_;
  PathStyle style_;
  std::optional<WaypointPath> walk_;
  std::optional<RoadCourse> course_;
  double phases_[6];
  std::vector<Tremor> tremors_[6];  // three of position [m], three of rotation [rad]
};

/// T_world_camera of a camera at `eye` that looks at `target` without roll.
Eigen::Isometry3d look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target);

}  // namespace holdfast::simulation
