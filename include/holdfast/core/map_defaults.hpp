// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Defaults that Map shares with the settings of the layers above, which set them for a run.
namespace holdfast {

/// Minimum number of shared points of a covisibility edge, as in ORB-SLAM (Mur-Artal et al. 2015, section III-D). A
/// bundle adjustment takes fewer for too few to determine the pose of a keyframe.
inline constexpr int default_covisibility_minimum = 15;

/// Bound on the magnitude of the static log-odds of a map point, so that a point can change its class within seconds.
inline constexpr double default_evidence_limit = 4.0;

}  // namespace holdfast
