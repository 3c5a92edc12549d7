// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/moving_world/evidence_settings.hpp"

namespace holdfast {

/// Scores poses of a frame by dense depth: the share of its cells whose depth agrees with that of keyframes. Moving
/// people bias this share less than they bias feature matches. Keeps its buffers; one thread.
class DepthAgreement {
 public:
  explicit DepthAgreement(const EvidenceSettings& settings = {}) : settings_(settings) {}

  /// Selects keyframes around `reference` for the comparison. Old ones are preferred, because people have moved farther
  /// since. False if there are none. The selection is valid until the map changes.
  bool choose(const Map& map, KeyFrameId reference, double timestamp);
  /// Share of the compared cells whose depth agrees with a keyframe's, 0 to 1; 0 when too few can be compared.
  double agreeing_share(const Frame& frame, const Eigen::Isometry3d& T_view_world) const;
  /// True if enough cells can be compared and less than `least_share` of them agree.
  bool disagrees(const Frame& frame, const Eigen::Isometry3d& T_view_world, double least_share) const;
  /// Share of agreeing cells among those that agree or see through a surface of a keyframe (measure more depth). Cells
  /// nearer than the surface of the keyframe are ignored as possible occlusions. 0 if the number or the share of
  /// agreeing cells is below the minimum of EvidenceSettings.
  double unoccluded_share(const Frame& frame, const Eigen::Isometry3d& T_view_world) const;
  /// Projective point-to-plane ICP (Chen and Medioni 1992; Newcombe et al. 2011, equations 16 to 24) of the frame's
  /// coarse depth image with those of the keyframes, with the predicted pose as initial value, and as a prior for
  /// unobservable directions.
  Eigen::Isometry3d align(const Frame& frame, const Eigen::Isometry3d& T_view_world) const;
  /// Estimates the colour-depth time offset as a pose on the inter-frame motion: T_view_camera. `step` is the motion
  /// T_frame_previous; `share_there` is agreeing_share(frame, T_camera_world), already computed by the caller.
  Eigen::Isometry3d find_view(const Frame& frame, const Eigen::Isometry3d& T_camera_world, double share_there,
                              const Eigen::Isometry3d& step) const;

 private:
  /// Numbers of cells of the frame by the result of the comparison.
  struct Counts {
    int compared = 0;
    int agreeing = 0;
    int farther = 0;  ///< farther than the surface of the keyframe
  };
  Counts count(const Frame& frame, const Eigen::Isometry3d& T_view_world) const;

  EvidenceSettings settings_;
  std::vector<const Frame*> keyframes_;
};

}  // namespace holdfast
