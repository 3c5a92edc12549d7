// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/surface_map.hpp"

#include <algorithm>
#include <utility>

#include "holdfast/core/check.hpp"

namespace holdfast {

std::size_t SurfaceMap::fused_view_count() const {
  return static_cast<std::size_t>(
      std::count_if(entries_.begin(), entries_.end(), [](const Entry& entry) { return !entry.view.only_carves(); }));
}

std::size_t SurfaceMap::memory_bytes() const {
  std::size_t bytes = field_.memory_bytes();
  for (const Entry& entry : entries_)
    bytes += entry.view.depth.total() * 2 + entry.view.colour.total() * 3 + entry.view.labels.total();
  return bytes;
}

double SurfaceMap::motion(const Eigen::Isometry3d& before, const Eigen::Isometry3d& after) const {
  const double depth = 0.75 * field_.settings().maximum_depth;
  double largest = 0.0;
  for (const double x : {0.0, static_cast<double>(camera_.width)})
    for (const double y : {0.0, static_cast<double>(camera_.height)}) {
      const Eigen::Vector3d point = camera_.back_project(x, y, depth);
      largest = std::max(largest, (after * point - before * point).norm());
    }
  return largest;
}

std::size_t SurfaceMap::update(const std::vector<KeptView>& views, const std::vector<Eigen::Isometry3d>& poses,
                               std::size_t max_moves) {
  HOLDFAST_CHECK(views.size() == poses.size(), views.size() << " views, " << poses.size() << " poses");
  std::vector<Entry> before = std::exchange(entries_, {});
  std::vector<std::pair<double, std::size_t>> moved;  // negative motion, position in entries_
  bool has_taken_out = false;
  const auto take_out = [&](const Entry& entry) {
    field_.take_out(entry.view, entry.fusion);
    has_taken_out = true;
  };
  std::size_t old = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const auto is_earlier = [&](const Entry& entry) { return entry.view.frame_index < views[i].frame_index; };
    while (old < before.size() && is_earlier(before[old])) take_out(before[old++]);
    const bool is_known = old < before.size() && before[old].view.frame_index == views[i].frame_index &&
                          before[old].view.depth.data == views[i].depth.data;
    if (!is_known) {
      entries_.push_back({views[i], field_.put_in(views[i], poses[i], next_number_++)});
      continue;
    }
    entries_.push_back(std::move(before[old++]));
    const double distance = motion(entries_.back().fusion.T_world_camera, poses[i]);
    if (distance > field_.settings().voxel) moved.emplace_back(-distance, i);
  }
  while (old < before.size()) take_out(before[old++]);

  std::sort(moved.begin(), moved.end());
  const std::size_t count = std::min(max_moves, moved.size());
  for (std::size_t k = 0; k < count; ++k) {
    Entry& entry = entries_[moved[k].second];
    entry.fusion = field_.move(entry.view, entry.fusion, poses[moved[k].second]);
  }
  moves_ += count;
  if (has_taken_out || count > 0) field_.remove_empty_blocks();
  return moved.size() - count;
}

}  // namespace holdfast
