// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iterator>

#include "holdfast/core/map.hpp"

namespace holdfast {

std::optional<std::uint32_t> Map::submap_of(KeyFrameId id) const {
  while (true) {
    if (const KeyFrame* keyframe = keyframes_.find(id)) return keyframe->submap;
    const auto removed = removed_keyframes_.find(id);
    if (removed == removed_keyframes_.end()) return std::nullopt;
    id = removed->second.parent;
  }
}

void Map::join_submaps(std::uint32_t first, std::uint32_t second) {
  const auto [kept, joined] = std::minmax(first, second);
  for (const KeyFrameId id : keyframes_.ids()) {
    KeyFrame& keyframe = keyframes_.at(id);
    if (keyframe.submap == joined) keyframe.submap = kept;
  }
}

std::vector<KeyFrameId> Map::keyframes_outside(std::uint32_t submap) const {
  std::vector<KeyFrameId> ids = keyframes_by_age();
  std::erase_if(ids, [&](KeyFrameId id) { return keyframes_.at(id).submap == submap; });
  return ids;
}

std::size_t Map::keyframes_in(std::uint32_t submap) const {
  if (last_submap_ == 0) return submap == 0 ? keyframes_.size() : 0;
  std::size_t count = 0;
  keyframes_.for_each([&](KeyFrameId, const KeyFrame& keyframe) { count += keyframe.submap == submap ? 1U : 0U; });
  return count;
}

void Map::keep_submap(std::uint32_t submap) {
  for (const KeyFrameId id : keyframes_outside(submap)) {
    const std::vector<MapPointId> points = keyframes_.at(id).frame.map_points;
    for (const MapPointId point : points)
      if (points_.contains(point)) remove_observation(point, id);
    for (const KeyFrameId child : keyframes_.at(id).children) keyframes_.at(child).parent = KeyFrameId();
    keyframes_.erase(id);
  }
  for (const KeyFrameId id : keyframes_.ids()) {
    const auto is_gone = [this](KeyFrameId other) { return !keyframes_.contains(other); };
    KeyFrame& keyframe = keyframes_.at(id);
    std::erase_if(keyframe.covisible, [&](const CovisibilityEdge& edge) { return is_gone(edge.keyframe); });
    std::erase_if(keyframe.loop_edges, is_gone);
    std::erase_if(keyframe.children, is_gone);
  }
  invalidate_copies();
}

}  // namespace holdfast
