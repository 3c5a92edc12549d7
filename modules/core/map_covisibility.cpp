// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <utility>

#include "holdfast/core/map.hpp"

namespace holdfast {

void Map::set_edge(KeyFrame& keyframe, KeyFrameId neighbour, int weight) {
  erase_edge(keyframe, neighbour);
  const std::uint64_t sequence = keyframes_.at(neighbour).sequence;
  const auto place = std::find_if(keyframe.covisible.begin(), keyframe.covisible.end(), [&](const CovisibilityEdge& e) {
    return e.weight < weight || (e.weight == weight && keyframes_.at(e.keyframe).sequence > sequence);
  });
  keyframe.covisible.insert(place, {neighbour, weight});
}

void Map::erase_edge(KeyFrame& keyframe, KeyFrameId neighbour) {
  std::erase_if(keyframe.covisible, [&](const CovisibilityEdge& edge) { return edge.keyframe == neighbour; });
}

void Map::update_covisibility(KeyFrameId id) {
  KeyFrame& keyframe = keyframes_.at(id);
  std::map<std::uint64_t, std::pair<KeyFrameId, int>> shared;  // by sequence, that is, in temporal order
  for (const MapPointId point_id : keyframe.frame.map_points) {
    const MapPoint* point = points_.find(point_id);
    if (point == nullptr) continue;
    for (const Observation& observation : point->observations) {
      if (observation.keyframe == id) continue;
      auto& entry = shared[keyframes_.at(observation.keyframe).sequence];
      entry.first = observation.keyframe;
      ++entry.second;
    }
  }

  for (const CovisibilityEdge& edge : keyframe.covisible) erase_edge(keyframes_.at(edge.keyframe), id);
  keyframe.covisible.clear();
  if (shared.empty()) return;

  const auto strongest = std::max_element(
      shared.begin(), shared.end(), [](const auto& a, const auto& b) { return a.second.second < b.second.second; });
  for (const auto& [sequence, entry] : shared) {
    const auto [neighbour, weight] = entry;
    if (weight < covisibility_minimum_ && sequence != strongest->first) continue;
    set_edge(keyframe, neighbour, weight);
    set_edge(keyframes_.at(neighbour), id, weight);
  }

  if (keyframe.sequence == 0 || keyframe.parent.valid()) return;
  // The parent is the strongest neighbour that is older, so that the spanning tree has no cycle.
  for (const CovisibilityEdge& edge : keyframe.covisible) {
    if (keyframes_.at(edge.keyframe).sequence >= keyframe.sequence) continue;
    set_parent(id, edge.keyframe);
    return;
  }
}

void Map::set_parent(KeyFrameId id, KeyFrameId older) {
  KeyFrame& keyframe = keyframes_.at(id);
  KeyFrame& parent = keyframes_.at(older);
  HOLDFAST_CHECK(!keyframe.parent.valid() && parent.sequence < keyframe.sequence,
                 "keyframe " << keyframe.sequence << " cannot become a child of keyframe " << parent.sequence);
  keyframe.parent = older;
  parent.children.push_back(id);
}

void Map::find_new_parents(KeyFrameId removed) {
  KeyFrame& keyframe = keyframes_.at(removed);
  for (const KeyFrameId child_id : keyframe.children) {
    KeyFrame& child = keyframes_.at(child_id);
    child.parent = keyframe.parent;
    // An older neighbour keeps the tree free of cycles: parents are always older than their children.
    for (const CovisibilityEdge& edge : child.covisible) {
      if (edge.keyframe == removed || keyframes_.at(edge.keyframe).sequence >= child.sequence) continue;
      child.parent = edge.keyframe;
      break;
    }
    if (child.parent.valid()) keyframes_.at(child.parent).children.push_back(child_id);
  }
  if (keyframe.parent.valid()) std::erase(keyframes_.at(keyframe.parent).children, removed);
}

void Map::remove_keyframe(KeyFrameId id) {
  KeyFrame& keyframe = keyframes_.at(id);
  HOLDFAST_CHECK(keyframe.parent.valid(), "keyframe " << keyframe.sequence << " holds the map in place");
  const std::vector<MapPointId> points = keyframe.frame.map_points;
  keep_votes(keyframe.frame);
  for (const MapPointId point_id : points) {
    const MapPoint* point = points_.find(point_id);
    if (point == nullptr) continue;
    const bool was_reference = point->reference_keyframe == id;
    remove_observation(point_id, id);
    if (was_reference && points_.contains(point_id)) update_point_geometry(point_id);
  }
  find_new_parents(id);
  for (const CovisibilityEdge& edge : keyframe.covisible) erase_edge(keyframes_.at(edge.keyframe), id);
  for (const KeyFrameId other : keyframe.loop_edges) std::erase(keyframes_.at(other).loop_edges, id);
  removed_keyframes_[id] = {keyframe.parent,
                            keyframe.frame.T_camera_world * keyframes_.at(keyframe.parent).frame.T_world_camera(),
                            keyframe.scale, keyframes_.at(keyframe.parent).scale};
  keyframes_.erase(id);
}

void Map::add_loop_edge(KeyFrameId first, KeyFrameId second) {
  HOLDFAST_CHECK(first != second, "keyframe " << first.slot << " closes a loop with itself");
  const auto link = [this](KeyFrameId from, KeyFrameId to) {
    std::vector<KeyFrameId>& edges = keyframes_.at(from).loop_edges;
    if (std::find(edges.begin(), edges.end(), to) == edges.end()) edges.push_back(to);
  };
  link(first, second);
  link(second, first);
}

std::vector<KeyFrameId> Map::keyframes_by_age() const {
  std::vector<KeyFrameId> ids = keyframes_.ids();
  std::sort(ids.begin(), ids.end(),
            [this](KeyFrameId a, KeyFrameId b) { return keyframes_.at(a).sequence < keyframes_.at(b).sequence; });
  return ids;
}

std::vector<KeyFrameId> Map::best_covisible(KeyFrameId id, int max_count) const {
  std::vector<KeyFrameId> best;
  for (const CovisibilityEdge& edge : keyframes_.at(id).covisible) {
    if (static_cast<int>(best.size()) >= max_count) break;
    best.push_back(edge.keyframe);
  }
  return best;
}

Eigen::Isometry3d Map::pose_of(KeyFrameId id) const {
  Eigen::Isometry3d T_camera_ancestor = Eigen::Isometry3d::Identity();
  double scale = scale_of(id);
  while (true) {
    if (const KeyFrame* keyframe = keyframes_.find(id)) return T_camera_ancestor * keyframe->frame.T_camera_world;
    const auto removed = removed_keyframes_.find(id);
    HOLDFAST_CHECK(removed != removed_keyframes_.end(), "keyframe " << id.slot << " was never in the map");
    Eigen::Isometry3d T_camera_parent = removed->second.T_camera_parent;
    scale *= removed->second.parent_scale / removed->second.scale;  // of the parent, as it is now
    T_camera_parent.translation() *= scale / removed->second.parent_scale;
    T_camera_ancestor = T_camera_ancestor * T_camera_parent;
    id = removed->second.parent;
  }
}

double Map::scale_of(KeyFrameId id) const {
  double since_removal = 1.0;
  while (true) {
    if (const KeyFrame* keyframe = keyframes_.find(id)) return since_removal * keyframe->scale;
    const auto removed = removed_keyframes_.find(id);
    HOLDFAST_CHECK(removed != removed_keyframes_.end(), "keyframe " << id.slot << " was never in the map");
    since_removal *= removed->second.scale / removed->second.parent_scale;
    id = removed->second.parent;
  }
}

}  // namespace holdfast
