// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "holdfast/interfaces/optimizer.hpp"

namespace holdfast::conformance {

/// A camera with an IMU among points; the measurements have the true biases and no noise. The first pose is fixed. In
/// two poses in a row nothing is visible, so that only inertial factors determine them. Poses, velocities, biases and
/// gravity are off in the problem.
struct KnownInertial {
  BundleProblem problem;
  std::vector<Eigen::Isometry3d> poses;     ///< T_camera_world
  std::vector<Eigen::Vector3d> velocities;  ///< by motion, which is by pose
  ImuBias bias;
  Eigen::Vector3d gravity;
};
KnownInertial known_inertial(const Camera& camera, std::uint64_t seed = 1, double scale = 1.0);

/// The poses of known_inertial() in which nothing is visible.
inline constexpr std::uint32_t first_hidden_pose = 3, last_hidden_pose = 4;

}  // namespace holdfast::conformance
