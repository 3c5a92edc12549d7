// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/dense_map/kept_view.hpp"
#include "holdfast/surface/surface_field.hpp"

namespace holdfast {

/// Images of frames between keyframes that a surface is fused from as well, where few views observed it: they see what
/// no keyframe sees, and average the noise of the sensor. Their masks are those that were propagated to them. A view
/// takes 384 kB, or 461 kB with labels, at 640x480 and a step of 2. Used by one thread.
class FusedFrames {
 public:
  /// `per_keyframe` views for each keyframe on average and at most `max_count`, at least `interval` [s] apart; above
  /// it, the view without which the gap in time is smallest is left out.
  FusedFrames(const ViewSampler& sampler, double interval, double per_keyframe, int max_count)
      : sampler_(sampler), interval_(interval), per_keyframe_(per_keyframe), max_count_(max_count) {}

  /// Whether the frame of this time stamp [s] is to be added if it is_worthwhile().
  bool is_due(double timestamp) const { return allowance_ >= 1.0 && !(timestamp - last_ < interval_); }
  /// Whether fewer than 8 views observed a surface of `field` in 2 % of the image or more, where `frame` observes one
  /// that is static. `left_out`: see add().
  static bool is_worthwhile(const Frame& frame, const SurfaceField& field, const std::vector<bool>& left_out);
  /// Notes that the frame of this time stamp is not worthwhile.
  void leave_out(double timestamp) { last_ = timestamp; }
  /// Notes that the keyframe of this time stamp is fused.
  void keyframe_kept(double timestamp) {
    last_ = timestamp;
    allowance_ += per_keyframe_;
  }
  /// Adds a frame with a pose, which follows the keyframe whose present pose is T_keyframe_world. `left_out`: see
  /// ViewSampler::sample().
  void add(const SensorFrame& sensor_frame, const Frame& frame, KeyFrameId keyframe,
           const Eigen::Isometry3d& T_keyframe_world, const std::vector<bool>& left_out);
  /// Removes views of keyframes that were removed with their submap.
  void forget_removed(const Map& map);

  /// By increasing frame index.
  const std::vector<KeptView>& views() const { return views_; }

 private:
  const ViewSampler& sampler_;
  double interval_, per_keyframe_;
  int max_count_;
  double allowance_ = 0.0;  // number of views that may be added now
  double last_ = -1e300;
  std::vector<KeptView> views_;
};

}  // namespace holdfast
