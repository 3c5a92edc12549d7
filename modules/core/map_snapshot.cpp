// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/map_snapshot.hpp"

#include "holdfast/core/map.hpp"

namespace holdfast {

namespace {

constexpr int essential_weight = 100;

void add_essential_edges(const Map& map, KeyFrameId id, std::vector<MapSnapshot::Covisibility>& edges) {
  const KeyFrame& keyframe = map.keyframe(id);
  if (keyframe.parent.valid()) edges.push_back({keyframe.parent, id});
  for (const CovisibilityEdge& edge : keyframe.covisible) {
    if (edge.weight < essential_weight) break;  // by decreasing weight
    if (map.keyframe(edge.keyframe).sequence < keyframe.sequence && edge.keyframe != keyframe.parent)
      edges.push_back({edge.keyframe, id});
  }
}

}  // namespace

MapSnapshot make_snapshot(const Map& map) {
  MapSnapshot snapshot;
  snapshot.keyframes.reserve(map.keyframes().size());
  for (const KeyFrameId id : map.keyframes_by_age()) {
    const KeyFrame& keyframe = map.keyframe(id);
    snapshot.keyframes.push_back({id, keyframe.sequence, keyframe.frame.timestamp, keyframe.frame.T_world_camera()});
    add_essential_edges(map, id, snapshot.covisibility);
    for (const KeyFrameId other : keyframe.loop_edges)
      if (map.keyframe(other).sequence < keyframe.sequence) snapshot.loops.push_back({other, id});
  }
  snapshot.points.reserve(map.points().size());
  map.points().for_each([&](MapPointId id, const MapPoint& point) {
    snapshot.points.push_back(
        {id, point.position, static_cast<std::uint32_t>(point.observations.size()), point.static_log_odds});
  });
  return snapshot;
}

}  // namespace holdfast
