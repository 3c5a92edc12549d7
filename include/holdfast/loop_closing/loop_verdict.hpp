// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "holdfast/core/id.hpp"

namespace holdfast {

/// What became of a candidate that was looked at closely; all but the first refuse it.
enum class LoopVerdict {
  closed,
  few_matches,             ///< too few descriptors agree
  no_alignment,            ///< the matched points fit no rigid motion
  few_inliers,             ///< too few points of the place are found where they should be
  small_share,             ///< many points of the place that should be seen are not
  one_corner,              ///< what is found fills too little of the view
  implausible_correction,  ///< odometry cannot have drifted that far on the way between
  pose_confirmed,          ///< old points lie where the present pose expects them: it is right already
  not_solved,              ///< the pose graph has no solution; the map is as before
};
inline constexpr std::size_t loop_verdicts = 9;

/// Size of a correction: how far the camera's centre moves and how far it turns.
struct PoseChange {
  double metres = 0.0;
  double degrees = 0.0;
};

/// Name of a verdict as in the report, such as "few inliers".
const char* loop_verdict_name(LoopVerdict verdict);

/// What was found when a candidate was looked at closely; zero for what its verdict did not need.
struct LoopTrial {
  KeyFrameId keyframe;
  KeyFrameId candidate;
  LoopVerdict verdict = LoopVerdict::few_matches;
  int matches = 0;        ///< descriptors that agree
  int aligned = 0;        ///< of these, such as fit one rigid motion
  int inliers = 0;        ///< points of the place found in the keyframe
  int expected = 0;       ///< points of the place that the keyframe should show
  int cells = 0;          ///< of 16 over the image that hold two inliers
  double way = 0.0;       ///< between the two through the map [m], with a metre for each radian
  PoseChange correction;  ///< that the loop asks for
};

/// What loop closing did so far; for the report.
struct LoopCounts {
  std::uint64_t keyframes = 0;  ///< processed
  std::uint64_t removed = 0;    ///< were gone from the map before their turn
  std::uint64_t points_fused = 0;
  std::array<std::uint64_t, loop_verdicts> verdicts{};  ///< candidates by LoopVerdict

  std::uint64_t of(LoopVerdict verdict) const { return verdicts[static_cast<std::size_t>(verdict)]; }
};

}  // namespace holdfast
