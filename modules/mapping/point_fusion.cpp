// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "holdfast/core/hamming.hpp"
#include "holdfast/geometry/expected_view.hpp"
#include "holdfast/mapping/local_mapper.hpp"
#include "reprojection.hpp"
#include "static_features.hpp"

namespace holdfast {

namespace {
constexpr int maximum_distance = 50;  // bits
constexpr float window = 3.0F;        // px at level 0
}  // namespace

std::vector<KeyFrameId> LocalMapper::fusion_targets(KeyFrameId id) const {
  std::vector<std::uint8_t> taken(map_.keyframes().slot_count(), 0);
  taken[id.slot] = 1;
  std::vector<KeyFrameId> targets;
  const auto take = [&](KeyFrameId keyframe) {
    if (taken[keyframe.slot] != 0) return;
    taken[keyframe.slot] = 1;
    targets.push_back(keyframe);
  };
  const std::vector<KeyFrameId> neighbours = map_.best_covisible(id, settings_.neighbours);
  for (const KeyFrameId neighbour : neighbours) take(neighbour);
  for (const KeyFrameId neighbour : neighbours)
    for (const KeyFrameId second : map_.best_covisible(neighbour, settings_.second_neighbours)) take(second);
  return targets;
}

std::vector<MapPointId> LocalMapper::points_seen_by(const std::vector<KeyFrameId>& keyframes) const {
  std::vector<MapPointId> points;
  std::vector<std::uint8_t> known(map_.points().slot_count(), 0);
  for (const KeyFrameId keyframe : keyframes)
    for (const MapPointId point : map_.keyframe(keyframe).frame.map_points)
      if (point.valid() && known[point.slot] == 0) {
        known[point.slot] = 1;
        points.push_back(point);
      }
  return points;
}

void LocalMapper::fuse_with_neighbours(KeyFrameId id) {
  std::vector<KeyFrameId> targets;
  std::vector<MapPointId> points;
  {
    const std::lock_guard lock(mutex_);
    targets = fusion_targets(id);
    points = points_seen_by({id});
  }
  for (const KeyFrameId target : targets) {
    const std::lock_guard lock(mutex_);
    fuse_into(target, points);
  }
  const std::lock_guard lock(mutex_);
  fuse_into(id, points_seen_by(targets));
  for (const MapPointId point : map_.keyframe(id).frame.map_points)
    if (point.valid()) map_.update_point(point);
  map_.update_covisibility(id, settings_.covisibility_minimum);
}

void LocalMapper::fuse_into(KeyFrameId target, const std::vector<MapPointId>& points) {
  const Frame& frame = map_.keyframe(target).frame;
  std::vector<std::uint32_t> candidates;
  for (const MapPointId id : points) {
    const MapPoint* point = map_.find_point(id);
    if (point == nullptr || map_.feature_of(id, target) >= 0) continue;
    const auto view = geometry::expected_view(frame, frame.T_camera_world, point->position, point->viewing_direction,
                                              point->minimum_distance, point->maximum_distance);
    if (!view) continue;

    candidates.clear();
    frame.grid.query(static_cast<float>(view->pixel.x()), static_cast<float>(view->pixel.y()),
                     window * frame.pyramid->scale[static_cast<std::size_t>(view->level)], frame.x, frame.y,
                     candidates);
    std::erase_if(candidates, [&](std::uint32_t feature) {
      const int octave = frame.features.octave[feature];
      if (octave < view->level - 1 || octave > view->level || !is_static(frame, feature)) return true;
      return !reprojects_onto(frame, feature, view->pixel, view->right_x);
    });
    const NearestDescriptors nearest =
        nearest_descriptors(point->descriptor, frame.features.descriptors.data(), candidates);
    if (nearest.best_index < 0 || nearest.best_distance > maximum_distance) continue;
    const auto feature = static_cast<std::uint32_t>(nearest.best_index);
    const MapPointId shown = frame.map_points[feature];
    if (!shown.valid()) {
      map_.add_observation(id, target, feature);
      map_.update_point(id);
      continue;
    }
    ++counts_.points_fused;
    if (map_.point(shown).observations.size() > point->observations.size())
      map_.fuse_points(id, shown);
    else
      map_.fuse_points(shown, id);
  }
}

}  // namespace holdfast
