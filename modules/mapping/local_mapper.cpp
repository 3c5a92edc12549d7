// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/mapping/local_mapper.hpp"

#include <algorithm>
#include <utility>

#include "holdfast/matching/frame_features.hpp"
#include "mapping_steps.hpp"

namespace holdfast {

namespace {

/// Updates the covisibility of a new keyframe, and sets its parent unless it is the first of its submap.
void link_keyframe(Map& map, KeyFrameId keyframe) {
  map.update_covisibility(keyframe);
  if (map.keyframe(keyframe).parent.valid()) return;
  // A keyframe without covisible neighbours (pose from odometry) becomes a child of the latest keyframe of its submap.
  const std::vector<KeyFrameId> by_age = map.keyframes_by_age();
  const std::uint32_t submap = map.keyframe(keyframe).submap;
  const auto last = std::find_if(by_age.rbegin() + 1, by_age.rend(),
                                 [&](KeyFrameId id) { return map.keyframe(id).submap == submap; });
  if (last != by_age.rend()) map.set_parent(keyframe, *last);
}

}  // namespace

KeyFrameId LocalMapper::insert(const MapAccess& map, const Frame& frame, bool points_wait, StageTimes& times,
                               std::uint32_t submap) {
  const StageTimer timer(times, "mapping: insertion");
  const KeyFrameId keyframe = map_.add_keyframe(frame);
  map_.keyframe(keyframe).submap = submap;
  ++counts_.keyframes_made;
  if (calibrator_) calibrator_->add(map, keyframe);
  drop_moving_features(map_, keyframe);
  if (!points_wait) make_points_from_depth(keyframe);
  for (const MapPointId point : map_.keyframe(keyframe).frame.map_points)
    if (point.valid()) map_.update_point(point);
  link_keyframe(map_, keyframe);
  map_.invalidate_copies();
  return keyframe;
}

KeyFrameId LocalMapper::begin(const MapAccess&, const Frame& frame,
                              std::span<const std::pair<Eigen::Vector3d, std::uint32_t>> points,
                              std::vector<MapPointId>& ids, StageTimes& times) {
  const StageTimer timer(times, "mapping: insertion");
  const KeyFrameId keyframe = map_.add_keyframe(frame);
  ++counts_.keyframes_made;
  ids.clear();
  for (const auto& [position, feature] : points) {
    const MapPointId point = map_.add_point(position, map_.keyframe(keyframe).sequence);
    map_.add_observation(point, keyframe, feature);
    map_.update_point(point);
    recent_points_.push_back(point);
    ids.push_back(point);
    ++counts_.points_triangulated;
  }
  link_keyframe(map_, keyframe);
  return keyframe;
}

std::vector<KeyFrameId> LocalMapper::refine(KeyFrameId keyframe, StageTimes& times) {
  stop_ = false;
  std::vector<MapPointId> triangulated;
  {
    const StageTimer timer(times, "mapping: points");
    {
      const MapLock map(map_, mutex_);
      if (map->find_keyframe(keyframe) == nullptr) return {};
      if (calibrator_) disparities_changed_ = calibrator_->correct(map) || disparities_changed_;
      // Its mask may have arrived since it was inserted.
      for (const MapPointId point : drop_moving_features(map_, keyframe))
        counts_.points_removed += drop_weak_point(map_, point) ? 1 : 0;
      make_points_from_depth(keyframe);
      counts_.points_moving += remove_moving_points(map_, settings_.moving_log_odds);
      counts_.points_removed += remove_weak_points(map_, keyframe, settings_, expects_masks_, recent_points_);
    }
    triangulated = triangulate_points(map_, mutex_, keyframe, settings_);
  }
  {
    const std::lock_guard lock(mutex_);
    recent_points_.insert(recent_points_.end(), triangulated.begin(), triangulated.end());
    counts_.points_triangulated += triangulated.size();
    if (map_.keyframes().size() < 2) return {};
  }
  {
    const StageTimer timer(times, "mapping: fusion");
    counts_.points_fused += fuse_with_neighbours(map_, mutex_, keyframe, settings_, matcher_);
  }
  {
    const StageTimer timer(times, "mapping: bundle adjustment");
    const BundleRemovals removals =
        adjust_bundle(map_, mutex_, keyframe, std::exchange(disparities_changed_, false), settings_, optimizer_, stop_);
    counts_.observations_removed += removals.observations;
    counts_.points_removed += removals.points;
  }
  if (calibrator_) {
    const StageTimer timer(times, "mapping: pair calibration");
    calibrator_->learn(keyframe);
  }
  const StageTimer timer(times, "mapping: culling");
  const std::lock_guard lock(mutex_);
  std::vector<KeyFrameId> removed = remove_redundant_keyframes(map_, keyframe, settings_, close_depth_factor_);
  counts_.keyframes_removed += removed.size();
  map_.invalidate_copies();
  return removed;
}

void LocalMapper::fuse_whole_map(const std::atomic<bool>& stop, StageTimes& times) {
  const StageTimer timer(times, "mapping: fusion");
  std::vector<KeyFrameId> keyframes;
  {
    const std::lock_guard lock(mutex_);
    keyframes = map_.keyframes_by_age();
  }
  for (const KeyFrameId id : keyframes) {
    if (stop) break;
    counts_.points_fused += fuse_with_neighbours(map_, mutex_, id, settings_, matcher_);
  }
  const std::lock_guard lock(mutex_);
  map_.invalidate_copies();
}

void LocalMapper::make_points_from_depth(KeyFrameId id) {
  const KeyFrame& keyframe = map_.keyframe(id);
  const Frame& frame = keyframe.frame;
  std::vector<std::pair<float, std::uint32_t>> by_depth;
  for (std::uint32_t i = 0; i < frame.size(); ++i)
    if (frame.has_depth(i)) by_depth.emplace_back(frame.depth[i], i);
  std::sort(by_depth.begin(), by_depth.end());

  const float close = static_cast<float>(close_depth_factor_ * frame.camera->baseline);
  const Eigen::Isometry3d T_world_camera = frame.T_world_camera();
  int rank = 0;
  for (const auto& [depth, feature] : by_depth) {
    if (depth > close && rank >= settings_.minimum_depth_points) break;
    ++rank;
    if (frame.map_points[feature].valid() || !is_static(frame, feature)) continue;
    const MapPointId point = map_.add_point(T_world_camera * frame.camera_point(feature), keyframe.sequence);
    map_.add_observation(point, id, feature);
    map_.update_point(point);
    recent_points_.push_back(point);
    ++counts_.points_from_depth;
  }
}

}  // namespace holdfast
