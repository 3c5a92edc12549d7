// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "holdfast/interfaces/optimizer.hpp"

namespace holdfast::conformance {

/// A pose problem whose exact solution is known: measurements without noise, and a first guess that is off by a few
/// centimetres and degrees. Every third observation has depth.
struct KnownPose {
  PoseProblem problem;
  Eigen::Isometry3d truth;
};
KnownPose known_pose(const Camera& camera, std::size_t points = 60, std::uint64_t seed = 1);

/// Two fixed cameras and three whose poses are off, on points that are off.
struct KnownBundle {
  BundleProblem problem;
  std::vector<Eigen::Isometry3d> poses;
  std::vector<Eigen::Vector3d> points;
};
KnownBundle known_bundle(const Camera& camera, std::uint64_t seed = 1);

/// Keyframes around a circle, with exact edges between neighbours and one that closes the circle; node 0 is fixed, the
/// others have drifted.
struct KnownGraph {
  PoseGraphProblem problem;
  std::vector<Eigen::Isometry3d> poses;
};
KnownGraph known_graph(std::uint64_t seed = 1);

/// Translation [m] plus angle [rad] between two poses.
double distance(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b);
/// Whether it maps lengths and angles as they are, in finite numbers.
bool is_rigid(const Eigen::Isometry3d& pose);

}  // namespace holdfast::conformance
