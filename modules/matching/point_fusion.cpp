// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/matching/point_fusion.hpp"

namespace holdfast {

FusionOutcome add_or_fuse(Map& map, MapPointId id, KeyFrameId keyframe, std::uint32_t feature,
                          FusionSurvivor survivor) {
  const MapPoint* point = map.find_point(id);
  if (point == nullptr || map.feature_of(id, keyframe) >= 0) return FusionOutcome::nothing;
  const MapPointId shown = map.keyframe(keyframe).frame.map_points[feature];
  if (!shown.valid()) {
    map.add_observation(id, keyframe, feature);
    map.update_point(id);
    return FusionOutcome::observation_added;
  }
  const bool keeps_shown =
      survivor == FusionSurvivor::more_observed && map.point(shown).observations.size() > point->observations.size();
  if (keeps_shown)
    map.fuse_points(id, shown);
  else
    map.fuse_points(shown, id);
  return FusionOutcome::points_fused;
}

}  // namespace holdfast
