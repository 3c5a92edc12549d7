// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/matching/point_fusion.hpp"
#include "holdfast/mapping/local_mapper.hpp"
#include "holdfast/matching/frame_features.hpp"
#include "holdfast/matching/point_block.hpp"

namespace holdfast {

namespace {
// Keyframe poses are bundle-adjusted, so a 3 px window suffices.
constexpr matching::WindowSettings fusion_windows{.radius = 3.0F, .frontal_radius = 3.0F};
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
  if (neighbours.empty() && map_.keyframe(id).parent.valid()) take(map_.keyframe(id).parent);
  for (const KeyFrameId neighbour : neighbours)
    for (const KeyFrameId second : map_.best_covisible(neighbour, settings_.second_neighbours)) take(second);
  return targets;
}

/// Buffers of the searches for one keyframe.
struct LocalMapper::FusionBuffers {
  PointBlock points;
  matching::SearchWindows windows;
  std::vector<std::uint8_t> usable;
  std::vector<FeatureMatch> matches;
};

void LocalMapper::fuse_with_neighbours(KeyFrameId id) {
  std::vector<KeyFrameId> targets;
  std::vector<MapPointId> points;
  {
    const std::lock_guard lock(mutex_);
    targets = fusion_targets(id);
    points = points_seen_by(map_, {&id, 1});
  }
  FusionBuffers buffers;
  for (const KeyFrameId target : targets) {
    const std::lock_guard lock(mutex_);
    fuse_into(target, points, buffers);
  }
  const std::lock_guard lock(mutex_);
  fuse_into(id, points_seen_by(map_, targets), buffers);
  for (const MapPointId point : map_.keyframe(id).frame.map_points)
    if (point.valid()) map_.update_point(point);
  map_.update_covisibility(id);
}

void LocalMapper::fuse_into(KeyFrameId target, const std::vector<MapPointId>& points, FusionBuffers& buffers) {
  const Frame& frame = map_.keyframe(target).frame;
  buffers.points.clear();
  for (const MapPointId id : points)
    if (const MapPoint* point = map_.find_point(id); point != nullptr && map_.feature_of(id, target) < 0)
      buffers.points.add(id, *point);
  buffers.windows.clear();
  matching::add_windows(
      frame, projection_into(frame, frame.T_camera_world), buffers.points, fusion_windows,
      [](std::uint32_t) { return true; }, buffers.windows);
  mark_static(frame, buffers.usable);
  matcher_.match_guided(frame, {buffers.windows, buffers.points.descriptors},
                        {.max_distance = frame.features.descriptors.type().strict_distance,
                         .position = matching::PositionGate::chi_square,
                         .assignment = matching::FeatureAssignment::every_point},
                        buffers.usable, buffers.matches);
  for (const FeatureMatch& match : buffers.matches)
    if (add_or_fuse(map_, buffers.points.ids[match.source], target, match.feature, FusionSurvivor::more_observed) ==
        FusionOutcome::points_fused)
      ++counts_.points_fused;
}

}  // namespace holdfast
