// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/matching/point_fusion.hpp"

#include <cstdint>
#include <mutex>

#include "holdfast/matching/frame_features.hpp"
#include "holdfast/matching/point_block.hpp"
#include "mapping_steps.hpp"

namespace holdfast {

namespace {

// Keyframe poses are bundle-adjusted, so a 3 px window suffices.
constexpr matching::WindowSettings fusion_windows{.radius = 3.0F, .frontal_radius = 3.0F};

std::vector<KeyFrameId> fusion_targets(const Map& map, KeyFrameId id, const MappingSettings& settings) {
  std::vector<std::uint8_t> taken(map.keyframes().slot_count(), 0);
  taken[id.slot] = 1;
  std::vector<KeyFrameId> targets;
  const auto take = [&](KeyFrameId keyframe) {
    if (taken[keyframe.slot] != 0) return;
    taken[keyframe.slot] = 1;
    targets.push_back(keyframe);
  };
  const std::vector<KeyFrameId> neighbours = map.best_covisible(id, settings.neighbours);
  for (const KeyFrameId neighbour : neighbours) take(neighbour);
  if (neighbours.empty() && map.keyframe(id).parent.valid()) take(map.keyframe(id).parent);
  for (const KeyFrameId neighbour : neighbours)
    for (const KeyFrameId second : map.best_covisible(neighbour, settings.second_neighbours)) take(second);
  return targets;
}

/// The searches for one keyframe, with their buffers.
struct PointFusion {
  Map& map;
  const FeatureMatcher& matcher;
  std::size_t points_fused = 0;
  PointBlock block = {};
  matching::SearchWindows windows = {};
  std::vector<std::uint8_t> usable = {};
  std::vector<FeatureMatch> matches = {};

  void fuse_into(KeyFrameId target, const std::vector<MapPointId>& points);
};

void PointFusion::fuse_into(KeyFrameId target, const std::vector<MapPointId>& points) {
  const Frame& frame = map.keyframe(target).frame;
  block.clear();
  for (const MapPointId id : points)
    if (const MapPoint* point = map.find_point(id); point != nullptr && map.feature_of(id, target) < 0)
      block.add(id, *point);
  windows.clear();
  matching::add_windows(
      frame, projection_into(frame, frame.T_camera_world), block, fusion_windows, [](std::uint32_t) { return true; },
      windows);
  mark_static(frame, usable);
  matcher.match_guided(frame, {windows, block.descriptors},
                       {.max_distance = frame.features.descriptors.type().strict_distance,
                        .position = matching::PositionGate::chi_square,
                        .assignment = matching::FeatureAssignment::every_point},
                       usable, matches);
  for (const FeatureMatch& match : matches)
    if (add_or_fuse(map, block.ids[match.source], target, match.feature, FusionSurvivor::more_observed) ==
        FusionOutcome::points_fused)
      ++points_fused;
}

}  // namespace

std::size_t fuse_with_neighbours(Map& map, MapMutex& mutex, KeyFrameId id, const MappingSettings& settings,
                                 const FeatureMatcher& matcher) {
  std::vector<KeyFrameId> targets;
  std::vector<MapPointId> points;
  {
    const std::lock_guard lock(mutex);
    targets = fusion_targets(map, id, settings);
    points = points_seen_by(map, {&id, 1});
  }
  PointFusion fusion{map, matcher};
  for (const KeyFrameId target : targets) {
    const std::lock_guard lock(mutex);
    fusion.fuse_into(target, points);
  }
  const std::lock_guard lock(mutex);
  fusion.fuse_into(id, points_seen_by(map, targets));
  for (const MapPointId point : map.keyframe(id).frame.map_points)
    if (point.valid()) map.update_point(point);
  map.update_covisibility(id);
  return fusion.points_fused;
}

}  // namespace holdfast
