// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/matching/point_block.hpp"

namespace holdfast {

void PointBlock::clear() {
  ids.clear(), descriptors.clear();
  for (std::vector<float>* values :
       {&x, &y, &z, &direction_x, &direction_y, &direction_z, &min_distance, &max_distance})
    values->clear();
}

void PointBlock::add(MapPointId id, const MapPoint& point) {
  ids.push_back(id);
  x.push_back(static_cast<float>(point.position.x()));
  y.push_back(static_cast<float>(point.position.y()));
  z.push_back(static_cast<float>(point.position.z()));
  direction_x.push_back(static_cast<float>(point.viewing_direction.x()));
  direction_y.push_back(static_cast<float>(point.viewing_direction.y()));
  direction_z.push_back(static_cast<float>(point.viewing_direction.z()));
  min_distance.push_back(point.minimum_distance);
  max_distance.push_back(point.maximum_distance);
  descriptors.append(point.descriptor, 0);
}

std::vector<MapPointId> points_seen_by(const Map& map, std::span<const KeyFrameId> keyframes) {
  std::vector<MapPointId> points;
  std::vector<std::uint8_t> known(map.points().slot_count(), 0);
  for (const KeyFrameId keyframe : keyframes)
    for (const MapPointId point : map.keyframe(keyframe).frame.map_points) {
      if (!point.valid() || known[point.slot] != 0) continue;
      known[point.slot] = 1;
      points.push_back(point);
    }
  return points;
}

}  // namespace holdfast
