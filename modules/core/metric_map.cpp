// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/metric_map.hpp"

namespace holdfast {

bool is_metric(const Map& map) {
  return scale_is_known(map.sensor()) || (map.inertia() && map.inertia()->scale == 1.0);
}

void make_metric(Map& map) {
  if (is_metric(map) || !map.inertia()) return;
  MapInertia inertia = *map.inertia();
  for (const KeyFrameId id : map.keyframes_by_age()) {
    KeyFrame& keyframe = map.keyframe(id);
    keyframe.frame.T_camera_world.translation() *= inertia.scale;
    keyframe.scale *= inertia.scale;
    if (keyframe.motion) keyframe.motion->velocity *= inertia.scale;
  }
  for (const MapPointId id : map.points().ids()) {
    MapPoint& point = map.point(id);
    point.position *= inertia.scale;
    point.minimum_distance *= static_cast<float>(inertia.scale);
    point.maximum_distance *= static_cast<float>(inertia.scale);
  }
  inertia.scale = 1.0;
  map.set_inertia(inertia);
  map.invalidate_copies();
}

}  // namespace holdfast
