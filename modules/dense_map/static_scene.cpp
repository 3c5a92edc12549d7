// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/dense_map/static_scene.hpp"

#include <algorithm>

#include "voxel_grid.hpp"

namespace holdfast {

StaticScene::StaticScene(const Camera& camera, const DenseMapSettings& settings, bool keeps_labels)
    : settings_(settings), sampler_(camera, settings, keeps_labels) {}

std::size_t StaticScene::view_bytes() const {
  return static_cast<std::size_t>(camera().width) * static_cast<std::size_t>(camera().height) *
         (sampler_.keeps_labels() ? 6 : 5);
}

const KeptView& StaticScene::add(KeyFrameId keyframe, const SensorFrame& frame, const CoarseView& coarse,
                                 const cv::Mat& labels, const std::vector<bool>& left_out) {
  if (static_cast<int>(views_.size()) >= settings_.keyframes) make_room();
  const auto next = std::upper_bound(views_.begin(), views_.end(), frame.index,
                                     [](std::uint64_t index, const KeptView& v) { return index < v.frame_index; });
  return *views_.insert(next, sampler_.sample(keyframe, frame, coarse, labels, left_out));
}

std::vector<CloudPoint> StaticScene::surface(const KeptView& view, std::size_t max_count) const {
  const int width = view.depth.cols, height = view.depth.rows;
  const auto pixels = [](int length, int step) { return static_cast<std::size_t>((length + step / 2) / step); };
  int step = 1;
  while (pixels(width, step) * pixels(height, step) > max_count && step < std::max(width, height)) ++step;
  std::vector<CloudPoint> points;
  for (int y = step / 2; y < height; y += step)
    for (int x = step / 2; x < width; x += step) {
      const double depth = view.depth_at(x, y);
      if (depth <= 0.0 || depth > settings_.maximum_depth || view.moves(x, y)) continue;
      const Eigen::Vector3f place = camera().back_project(x, y, depth).cast<float>();
      const cv::Vec3b& colour = view.colour.ptr<cv::Vec3b>(y)[x];
      points.push_back({place.x(), place.y(), place.z(), colour[2], colour[1], colour[0]});
    }
  return points;
}

void StaticScene::make_room() { views_.erase(views_.begin() + static_cast<std::ptrdiff_t>(densest_view(views_))); }

void StaticScene::forget_removed(const Map& map) {
  std::erase_if(views_, [&](const KeptView& view) { return !map.submap_of(view.keyframe); });
}

std::vector<CloudPoint> StaticScene::cloud(const Map& map) const {
  dense_map::VoxelGrid grid = dense_map::fuse(*this, dense_map::poses_of(*this, map), settings_.minimum_views);
  std::vector<dense_map::Voxel>& voxels = grid.voxels();
  std::erase_if(voxels, [&](const dense_map::Voxel& v) { return v.views < settings_.minimum_views || v.has_left(); });
  std::sort(voxels.begin(), voxels.end(), [](const auto& a, const auto& b) { return a.key < b.key; });
  std::vector<CloudPoint> points;
  points.reserve(voxels.size());
  for (const dense_map::Voxel& voxel : voxels) {
    const auto count = static_cast<double>(voxel.points);
    const Eigen::Vector3d place = grid.corner_of(voxel.key) + Eigen::Vector3d(voxel.x, voxel.y, voxel.z) / count;
    const auto mean = [&](std::uint32_t sum) {
      return static_cast<std::uint8_t>((sum + voxel.points / 2) / voxel.points);
    };
    points.push_back({static_cast<float>(place.x()), static_cast<float>(place.y()), static_cast<float>(place.z()),
                      mean(voxel.red), mean(voxel.green), mean(voxel.blue)});
  }
  return points;
}

}  // namespace holdfast
