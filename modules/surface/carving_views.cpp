// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/carving_views.hpp"

#include <algorithm>
#include <cmath>

namespace holdfast {

namespace {

constexpr int cells = 2;  // of the coarse view in a pixel, along each side

Camera camera_of(const Camera& camera, const CoarseGrid& grid) {
  constexpr double step = cells * CoarseGrid::step;
  Camera coarse = camera;
  coarse.distortion = {};
  coarse.width = grid.columns / cells, coarse.height = grid.rows / cells;
  coarse.fx = camera.fx / step, coarse.fy = camera.fy / step;
  coarse.cx = (camera.cx - static_cast<double>(grid.left)) / step - 0.5;
  coarse.cy = (camera.cy - static_cast<double>(grid.top)) / step - 0.5;
  return coarse;
}

/// Smallest depth of the cells of a pixel, or 0 if one is missing.
std::uint16_t smallest_depth(const CoarseView& view, int x, int y) {
  float smallest = 1e6F;
  for (int row = cells * y; row < cells * (y + 1); ++row)
    for (int column = cells * x; column < cells * (x + 1); ++column)
      smallest = std::min(smallest, view.depth[static_cast<std::size_t>(row * view.grid.columns + column)]);
  const double units = static_cast<double>(smallest) / KeptView::depth_unit;
  return static_cast<std::uint16_t>(std::clamp(units, 0.0, static_cast<double>(KeptView::depth_bits)));
}

}  // namespace

void CarvingViews::add(const Frame& frame, KeyFrameId keyframe, const Eigen::Isometry3d& T_keyframe_world) {
  const CoarseView& coarse = frame.coarse;
  if (coarse.empty()) return;
  if (!camera_) camera_ = std::make_shared<const Camera>(camera_of(*frame.camera, coarse.grid));
  if (static_cast<int>(views_.size()) >= max_count_) make_room();
  last_ = frame.timestamp;
  views_.push_back({.keyframe = keyframe,
                    .frame_index = frame.index,
                    .timestamp = frame.timestamp,
                    .colour = {},
                    .depth = cv::Mat(camera_->height, camera_->width, CV_16UC1),
                    .coarse_camera = camera_,
                    .T_view_keyframe = frame.T_view_world() * T_keyframe_world.inverse()});
  cv::Mat& depth = views_.back().depth;
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x) depth.at<std::uint16_t>(y, x) = smallest_depth(coarse, x, y);
}

void CarvingViews::forget_removed(const Map& map) {
  std::erase_if(views_, [&](const KeptView& view) { return !map.submap_of(view.keyframe); });
}

void CarvingViews::make_room() { views_.erase(views_.begin() + static_cast<std::ptrdiff_t>(densest_view(views_))); }

}  // namespace holdfast
