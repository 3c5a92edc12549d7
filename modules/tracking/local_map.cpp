// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/local_map.hpp"

#include <algorithm>

namespace holdfast {

void LocalMap::update(Map& map, const Frame& frame, std::uint64_t map_version) {
  const KeyFrameId previous_reference = reference_keyframe_;
  const bool voted = vote(map, frame);
  if (!voted && !reference_keyframe_.valid()) return;
  if (map_version == map_version_ && reference_keyframe_ == previous_reference) return;
  write_counts(map);
  map_version_ = map_version;
  if (voted) collect_keyframes(map);
  collect_points(map);
}

bool LocalMap::vote(const Map& map, const Frame& frame) {
  votes_.resize(map.keyframes().slot_count(), 0);
  voted_.clear();
  for (const MapPointId id : frame.map_points) {
    if (!id.valid()) continue;
    const MapPoint* point = map.find_point(id);
    if (point == nullptr) continue;
    for (const Observation& observation : point->observations)
      if (votes_[observation.keyframe.slot]++ == 0) voted_.push_back(observation.keyframe);
  }
  if (voted_.empty()) return false;
  // Most votes first; of equal ones the later slot, which tends to be the later keyframe.
  std::sort(voted_.begin(), voted_.end(), [&](KeyFrameId a, KeyFrameId b) {
    return votes_[a.slot] != votes_[b.slot] ? votes_[a.slot] > votes_[b.slot] : a.slot > b.slot;
  });
  reference_keyframe_ = voted_.front();
  for (const KeyFrameId id : voted_) votes_[id.slot] = 0;
  return true;
}

void LocalMap::collect_keyframes(const Map& map) {
  keyframes_.clear();
  std::vector<std::uint8_t> taken(map.keyframes().slot_count(), 0);
  const auto take = [&](KeyFrameId id) {
    if (!id.valid() || taken[id.slot] != 0 || static_cast<int>(keyframes_.size()) >= most_keyframes_) return false;
    taken[id.slot] = 1;
    keyframes_.push_back(id);
    return true;
  };
  for (const KeyFrameId id : voted_) take(id);
  const std::size_t sharing = keyframes_.size();
  constexpr int neighbours = 10;
  for (std::size_t i = 0; i < sharing; ++i) {
    const KeyFrame& keyframe = map.keyframe(keyframes_[i]);
    for (const KeyFrameId neighbour : map.best_covisible(keyframes_[i], neighbours))
      if (take(neighbour)) break;
    for (const KeyFrameId child : keyframe.children)
      if (take(child)) break;
    take(keyframe.parent);
  }
}

void LocalMap::collect_points(const Map& map) {
  points_.clear();
  index_of_slot_.assign(map.points().slot_count(), -1);
  std::erase_if(keyframes_, [&](KeyFrameId id) { return map.find_keyframe(id) == nullptr; });
  const std::vector<MapPointId> ids = points_seen_by(map, keyframes_);
  // Points lie anywhere in memory, so that each is fetched before the ones ahead of it are copied.
  std::vector<const MapPoint*> seen;
  seen.reserve(ids.size());
  for (const MapPointId id : ids) {
    seen.push_back(&map.point(id));
    __builtin_prefetch(&seen.back()->position);
    __builtin_prefetch(&seen.back()->descriptor);
  }
  constexpr std::size_t ahead = 8;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (i + ahead < ids.size()) __builtin_prefetch(seen[i + ahead]->descriptor.row(0));
    index_of_slot_[ids[i].slot] = static_cast<std::int32_t>(i);
    points_.add(ids[i], *seen[i]);
  }
  visible_.assign(points_.size(), 0);
  found_.assign(points_.size(), 0);
}

void LocalMap::mark_shown(const Frame& frame) {
  shown_.assign(points_.size(), 0);
  for (const MapPointId id : frame.map_points) {
    if (!id.valid() || id.slot >= index_of_slot_.size()) continue;
    const std::int32_t index = index_of_slot_[id.slot];
    if (index >= 0 && points_.ids[static_cast<std::size_t>(index)] == id) shown_[static_cast<std::size_t>(index)] = 1;
  }
}

void LocalMap::project(const Frame& frame, float radius_factor, matching::SearchWindows& windows) {
  mark_shown(frame);
  const matching::WindowSettings settings{.radius = 4.0F, .frontal_radius = 2.5F, .factor = radius_factor};
  const auto is_wanted = [&](std::uint32_t i) {
    ++visible_[i];
    return shown_[i] == 0;
  };
  matching::add_windows(frame, projection_into(frame, frame.T_camera_world), points_, settings, is_wanted, windows);
}

void LocalMap::count_found(const Frame& frame) {
  mark_shown(frame);
  for (std::size_t i = 0; i < points_.size(); ++i) found_[i] += shown_[i];
}

void LocalMap::write_counts(Map& map) {
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if ((visible_[i] | found_[i]) == 0) continue;
    if (MapPoint* point = map.find_point(points_.ids[i])) {
      point->visible_count += visible_[i];
      point->found_count += found_[i];
    }
    visible_[i] = found_[i] = 0;
  }
}

}  // namespace holdfast
