// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

namespace holdfast::simulation {

/// How the camera moves, after the names of the TUM fr3 sequences (Sturm et al., IROS 2012):
/// fixed: held by hand without moving; xyz: along three axes, looking the same way; halfsphere: on a half sphere of 1 m
/// around the desk; rpy: turning about all axes at one place.
enum class PathKind { fixed, xyz, halfsphere, rpy };

/// "static", "xyz", "halfsphere", "rpy".
const char* to_string(PathKind kind);
/// The kind of that name; throws ConfigurationError naming the known ones.
PathKind path_kind(const std::string& name);
std::vector<std::string> path_names();

/// The camera's pose as a smooth function of time: what a hand does, with a slight tremor. Starts at speed zero,
/// reaches its speed after a second, goes on for ever. The seed changes phases and tremor, not the kind of motion.
class CameraPath {
 public:
  CameraPath(PathKind kind, std::uint64_t seed);

  /// T_world_camera at a time >= 0 [s]; camera frame x right, y down, z forward; world z up.
  Eigen::Isometry3d pose(double time) const;

 private:
  struct Tremor {
    double amplitude, frequency, phase;
  };

  PathKind kind_;
  double phases_[6];
  std::vector<Tremor> tremors_[6];  // three of position [m], three of rotation [rad]
};

/// T_world_camera of a camera at `eye` that looks at `target` with the horizon level.
Eigen::Isometry3d look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target);

}  // namespace holdfast::simulation
