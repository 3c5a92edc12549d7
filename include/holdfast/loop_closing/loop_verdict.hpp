// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "holdfast/core/id.hpp"

namespace holdfast {

/// Result of the verification of a candidate; all values except the first one reject it.
enum class LoopVerdict {
  closed,
  few_matches,             ///< too few descriptor matches
  no_alignment,            ///< no rigid motion fits enough matched points
  few_inliers,             ///< too few points of the candidate are matched by the guided search
  small_share,             ///< too small a fraction of the points predicted to be visible is matched
  poor_coverage,           ///< the matches cover too small a part of the image
  implausible_correction,  ///< the correction exceeds the drift bound of the path
  pose_confirmed,          ///< old points confirm the current pose, which is the competing hypothesis
  other_classes,           ///< the matched points and features are of different classes
  not_solved,              ///< the pose graph has no solution; the map is unchanged
};
inline constexpr std::size_t loop_verdicts = 10;

/// Magnitude of a correction: translation of the camera centre and angle of rotation.
struct PoseChange {
  double metres = 0.0;
  double degrees = 0.0;
};

/// Name of a verdict as in the report, such as "few inliers".
const char* loop_verdict_name(LoopVerdict verdict);

/// Measurements of the verification of a candidate; values that were not computed are zero.
struct CandidateReport {
  KeyFrameId keyframe;
  KeyFrameId candidate;
  LoopVerdict verdict = LoopVerdict::few_matches;
  int matches = 0;             ///< descriptor matches
  int aligned = 0;             ///< inliers of the rigid alignment among them
  int inliers = 0;             ///< points of the candidate that are matched in the keyframe
  int expected = 0;            ///< points of the candidate that are predicted to be visible in the keyframe
  double class_agreement = 1;  ///< mean share of the votes of these points for the classes of their features
  int cells = 0;               ///< number of 16 cells over the image with at least two inliers
  bool joins_submaps = false;  ///< the two are in different submaps
  double path_length = 0.0;    ///< length of the path between the two in the map [m], with one metre per radian
  PoseChange correction;       ///< correction that the loop requires
  double scale = 1.0;          ///< scale of the Sim(3) from keyframe to candidate; 1 if depth is measured
};

/// Cumulative loop-closing statistics.
struct LoopCounts {
  std::uint64_t keyframes = 0;  ///< processed
  std::uint64_t removed = 0;    ///< removed from the map before they were processed
  std::uint64_t points_fused = 0;
  std::array<std::uint64_t, loop_verdicts> verdicts{};  ///< candidates by LoopVerdict

  std::uint64_t of(LoopVerdict verdict) const { return verdicts[static_cast<std::size_t>(verdict)]; }
};

}  // namespace holdfast
