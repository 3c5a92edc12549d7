// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Default values that Map shares with settings of higher layers.
namespace holdfast {

/// Minimum number of shared points of a covisibility edge, as in ORB-SLAM (Mur-Artal et al. 2015, section III-D).
/// Bundle adjustment also requires this number to estimate the pose of a keyframe.
inline constexpr int default_covisibility_minimum = 15;

/// Bound on the magnitude of the static log-odds of a map point, so that the classification as static or moving can
/// change within seconds.
inline constexpr double default_evidence_limit = 4.0;

}  // namespace holdfast
