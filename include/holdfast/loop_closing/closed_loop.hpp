// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include "holdfast/core/id.hpp"
#include "holdfast/loop_closing/loop_verdict.hpp"

namespace holdfast {

/// A loop that was detected and corrected.
struct ClosedLoop {
  KeyFrameId keyframe;   ///< keyframe at the end of the loop
  KeyFrameId candidate;  ///< keyframe of the revisited place
  int inliers = 0;       ///< map points of the candidate that are matched in the keyframe
  int points_fused = 0;
  /// Whether the loop joins two submaps (KeyFrame::submap).
  bool joins_submaps = false;
  /// Length of the shortest path between the two before the correction [m]; 0 between submaps.
  double path_length = 0.0;
  PoseChange correction;  ///< measured correction of the keyframe
  double scale = 1.0;     ///< scale of the Sim(3) from keyframe to candidate; 1 if depth is measured
  /// Measured relative pose, which maps points of the candidate's camera frame to the keyframe's.
  Eigen::Isometry3d T_keyframe_candidate = Eigen::Isometry3d::Identity();
  double seconds = 0.0;  ///< duration of the correction
};

}  // namespace holdfast
