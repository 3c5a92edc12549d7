// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/map_snapshot.hpp"

#include "holdfast/core/map.hpp"

namespace holdfast {

MapSnapshot make_snapshot(const Map& map) {
  MapSnapshot snapshot;
  snapshot.keyframes.reserve(map.keyframes().size());
  for (const KeyFrameId id : map.keyframes_by_age()) {
    const KeyFrame& keyframe = map.keyframe(id);
    snapshot.keyframes.push_back({id, keyframe.sequence, keyframe.frame.timestamp, keyframe.frame.T_world_camera()});
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
