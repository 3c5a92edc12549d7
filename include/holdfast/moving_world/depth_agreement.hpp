// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/map.hpp"

namespace holdfast {

/// Compares poses of a frame by dense depth: under the right pose, most of what the frame observes agrees with the
/// depth of keyframes. Moving people can bias the matches of features, but not the depth of the room. Keeps its
/// buffers; one thread.
class DepthAgreement {
 public:
  /// Selects keyframes around `reference` to compare with: old ones rather than recent ones, in which people who walk
  /// are still at nearly the same place. False when there are none. The selection is valid until the map changes.
  bool choose(const Map& map, KeyFrameId reference, double timestamp);
  /// Share of the compared cells whose depth agrees with a keyframe's, 0 to 1; 0 when too few can be compared.
  double share(const Frame& frame, const Eigen::Isometry3d& T_view_world) const;
  /// Estimates the colour-depth time offset as a pose on the inter-frame motion: T_view_camera. `step` is the motion
  /// T_frame_previous.
  Eigen::Isometry3d find_view(const Frame& frame, const Eigen::Isometry3d& T_camera_world,
                              const Eigen::Isometry3d& step) const;

 private:
  std::vector<const Frame*> keyframes_;
};

}  // namespace holdfast
