// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/map.hpp"

namespace holdfast {

/// Tells which of several poses of a frame is right by dense depth: under the right one, most of what the frame sees
/// lies where keyframes saw it. People who lead the features astray do not lead the room astray. Keeps its buffers; one
/// thread.
class DepthAgreement {
 public:
  /// Chooses keyframes around `reference` to compare with: old ones rather than young ones, in which those who walk
  /// are still where they were. False when there are none.
  bool choose(const Map& map, KeyFrameId reference, double timestamp);
  /// Share of the compared cells whose depth agrees with a keyframe's, 0 to 1.
  double share(const Frame& frame, const Eigen::Isometry3d& T_view_world) const;
  /// Where on the camera's way the depth image was taken: T_view_camera. `step` is the motion T_frame_previous.
  Eigen::Isometry3d find_view(const Frame& frame, const Eigen::Isometry3d& T_camera_world,
                              const Eigen::Isometry3d& step) const;

 private:
  std::vector<const Frame*> keyframes_;  // valid until the map changes
};

}  // namespace holdfast
