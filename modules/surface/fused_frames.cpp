// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/fused_frames.hpp"

#include <algorithm>

namespace holdfast {

namespace {

/// Static points of the coarse view of a frame, one of `stride` x `stride` cells, in world coordinates [m].
std::vector<Eigen::Vector3f> static_points(const Frame& frame, int stride, double maximum_depth,
                                           const std::vector<bool>& left_out) {
  const CoarseView& coarse = frame.coarse;
  const Eigen::Isometry3d T_world_view = frame.T_view_world().inverse();
  const auto moves = [&](std::size_t cell) {
    if (!coarse.static_log_odds.empty() && coarse.static_log_odds[cell] < 0.0F) return true;
    return !coarse.mask.labels.empty() && is_left_out(coarse.mask.labels[cell], left_out);
  };
  std::vector<Eigen::Vector3f> points;
  for (int row = stride / 2; row < coarse.grid.rows; row += stride)
    for (int column = stride / 2; column < coarse.grid.columns; column += stride) {
      const auto cell = static_cast<std::size_t>(row * coarse.grid.columns + column);
      const double depth = static_cast<double>(coarse.depth[cell]);
      if (depth <= 0.0 || depth > maximum_depth || moves(cell)) continue;
      const Eigen::Vector3d ray((coarse.grid.x_of(column) - frame.camera->cx) / frame.camera->fx,
                                (coarse.grid.y_of(row) - frame.camera->cy) / frame.camera->fy, 1.0);
      points.emplace_back((T_world_view * (depth * ray)).cast<float>());
    }
  return points;
}

}  // namespace

bool FusedFrames::is_worthwhile(const Frame& frame, const SurfaceField& field, const std::vector<bool>& left_out) {
  constexpr int stride = 4;        // [cells]
  constexpr int enough_views = 8;  // average the noise to a third
  constexpr double smallest_share = 0.02;
  if (frame.coarse.empty()) return false;
  const std::vector<Eigen::Vector3f> points = static_points(frame, stride, field.settings().maximum_depth, left_out);
  const double all = static_cast<double>(frame.coarse.grid.size()) / (stride * stride);
  return static_cast<double>(field.count_unobserved(points, enough_views)) >= smallest_share * all;
}

void FusedFrames::add(const SensorFrame& sensor_frame, const Frame& frame, KeyFrameId keyframe,
                      const Eigen::Isometry3d& T_keyframe_world, const std::vector<bool>& left_out) {
  if (static_cast<int>(views_.size()) >= max_count_)
    views_.erase(views_.begin() + static_cast<std::ptrdiff_t>(densest_view(views_)));
  last_ = frame.timestamp;
  allowance_ -= 1.0;
  views_.push_back(sampler_.sample(keyframe, sensor_frame, frame.coarse, {}, left_out));
  views_.back().T_view_keyframe = frame.T_view_world() * T_keyframe_world.inverse();
}

void FusedFrames::forget_removed(const Map& map) {
  std::erase_if(views_, [&](const KeptView& view) { return !map.submap_of(view.keyframe); });
}

}  // namespace holdfast
