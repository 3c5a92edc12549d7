// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/map.hpp"

namespace holdfast {

/// Which keyframes depth is compared with, and when a comparison counts; the defaults are those of EvidenceSettings.
struct DepthAgreementSettings {
  int keyframes = 3;   ///< maximum number of keyframes to compare with
  double age = 0.7;    ///< age from which a keyframe is preferred, because people have walked on since [s]
  int cells = 50;      ///< minimum number of cells for a share of them to be significant
  double share = 0.2;  ///< minimum share of the compared cells that agree for a pose to be supported
};

/// Compares poses of a frame by dense depth: under the right pose, most of what the frame observes agrees with the
/// depth of keyframes. Moving people can bias the matches of features, but not the depth of the room. Keeps its
/// buffers; one thread.
class DepthAgreement {
 public:
  explicit DepthAgreement(const DepthAgreementSettings& settings = {}) : settings_(settings) {}

  /// Selects keyframes around `reference` to compare with: old ones rather than recent ones, in which people who walk
  /// are still at nearly the same place. False when there are none. The selection is valid until the map changes.
  bool choose(const Map& map, KeyFrameId reference, double timestamp);
  /// Share of the compared cells whose depth agrees with a keyframe's, 0 to 1; 0 when too few can be compared.
  double share(const Frame& frame, const Eigen::Isometry3d& T_view_world) const;
  /// Whether cells enough can be compared, and a smaller share than `least_share` of them agrees.
  bool disagrees(const Frame& frame, const Eigen::Isometry3d& T_view_world, double least_share) const;
  /// Share of the cells that agree among those that agree or contradict a keyframe: they measure more depth than a
  /// static surface allows. Cells that are nearer than the keyframe's surface are not counted, because a person may
  /// stand there. 0 when too few cells agree, or a smaller share of those compared than required.
  double support(const Frame& frame, const Eigen::Isometry3d& T_view_world) const;
  /// Aligns the depth image of the frame with those of the keyframes, beginning at a predicted pose, which remains
  /// the estimate in directions that depth does not determine. Projective point-to-plane ICP (Chen and Medioni 1992;
  /// Newcombe et al. 2011, equations 16 to 24) on coarse views.
  Eigen::Isometry3d align(const Frame& frame, const Eigen::Isometry3d& T_view_world) const;
  /// Estimates the colour-depth time offset as a pose on the inter-frame motion: T_view_camera. `step` is the motion
  /// T_frame_previous; `share_there` is share(frame, T_camera_world), which the caller knows.
  Eigen::Isometry3d find_view(const Frame& frame, const Eigen::Isometry3d& T_camera_world, double share_there,
                              const Eigen::Isometry3d& step) const;

 private:
  /// Numbers of cells of the frame by what the keyframes measured there.
  struct Counts {
    int compared = 0;
    int agreeing = 0;
    int farther = 0;  ///< than the keyframe's surface
  };
  Counts count(const Frame& frame, const Eigen::Isometry3d& T_view_world) const;

  DepthAgreementSettings settings_;
  std::vector<const Frame*> keyframes_;
};

}  // namespace holdfast
