// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "holdfast/evaluation/evaluation.hpp"

namespace holdfast {

/// Orientation of a camera in the order of aviation (yaw, then pitch, then roll; ISO 1151-1) with the optical axis as
/// the forward axis, unwrapped: values beyond 180 degrees continue a rotation.
struct CameraAngles {
  double timestamp = 0.0;  ///< [s]
  double roll = 0.0;       ///< about the optical axis, positive clockwise as the camera sees it turn itself [deg]
  double pitch = 0.0;      ///< of the optical axis above the horizontal plane [deg]
  double yaw = 0.0;        ///< of the optical axis about the vertical, positive to the right [deg]
};

/// Angles of the ground truth and of the aligned estimate, one for each pose of Evaluation::truth_track and
/// Evaluation::estimate_track.
struct EvaluatedAngles {
  std::vector<CameraAngles> truth;
  std::vector<CameraAngles> estimate;
};

/// Computes the angles in a common level frame. The vertical is the axis of the world nearest to the mean upright
/// direction of the camera, or, where that is undecided, the upright direction of its first true pose; yaw is 0 at the
/// first true pose. Each angle continues that of the pose before it, also where the camera looks straight up or down;
/// those of the estimate are the values nearest to the ground truth of the same time. Both are empty without truth.
EvaluatedAngles camera_angles(const Evaluation& evaluation);

}  // namespace holdfast
