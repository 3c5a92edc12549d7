// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <memory>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/dense_map/kept_view.hpp"

namespace holdfast {

/// Coarse depth images of frames between keyframes, by which a surface is carved where few keyframes look: the smallest
/// depth of each 8x8 pixels of the camera in 16 bits, 10 kB at 640x480. They need no mask: a person in front of a
/// surface hides it, and carves nothing behind. Used by one thread.
class CarvingViews {
 public:
  /// As many views are kept for each keyframe that is kept.
  static constexpr int per_keyframe = 8;

  /// At most `max_count` views, at least `interval` [s] apart; above it, the view without which the gap in time is
  /// smallest is left out.
  CarvingViews(double interval, int max_count) : interval_(interval), max_count_(max_count) {}

  /// Whether the frame of this time stamp [s] is to be added.
  bool is_due(double timestamp) const { return !(timestamp - last_ < interval_); }
  /// Notes that the keyframe of this time stamp carves.
  void keyframe_kept(double timestamp) { last_ = timestamp; }
  /// Adds a frame with a pose, which follows the keyframe whose present pose is T_keyframe_world.
  void add(const Frame& frame, KeyFrameId keyframe, const Eigen::Isometry3d& T_keyframe_world);
  /// Removes views of keyframes that were removed with their submap.
  void forget_removed(const Map& map);

  /// By increasing frame index; all KeptView::only_carves.
  const std::vector<KeptView>& views() const { return views_; }

 private:
  void make_room();

  double interval_;
  int max_count_;
  double last_ = -1e300;
  std::shared_ptr<const Camera> camera_;
  std::vector<KeptView> views_;
};

}  // namespace holdfast
