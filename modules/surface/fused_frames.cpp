// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/fused_frames.hpp"

namespace holdfast {

void FusedFrames::add(const SensorFrame& sensor_frame, const Frame& frame, KeyFrameId keyframe,
                      const Eigen::Isometry3d& T_keyframe_world, const std::vector<bool>& left_out) {
  if (static_cast<int>(views_.size()) >= max_count_)
    views_.erase(views_.begin() + static_cast<std::ptrdiff_t>(densest_view(views_)));
  last_ = frame.timestamp;
  views_.push_back(sampler_.sample(keyframe, sensor_frame, frame.coarse, {}, left_out));
  views_.back().T_view_keyframe = frame.T_view_world() * T_keyframe_world.inverse();
}

void FusedFrames::forget_removed(const Map& map) {
  std::erase_if(views_, [&](const KeptView& view) { return !map.submap_of(view.keyframe); });
}

}  // namespace holdfast
