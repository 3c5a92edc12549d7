// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/mapping/local_mapper.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "holdfast/matching/frame_features.hpp"

namespace holdfast {

KeyFrameId LocalMapper::insert(const MapAccess& map, const Frame& frame, bool points_wait, StageTimes& times,
                               std::uint32_t submap) {
  const StageTimer timer(times, "mapping: insertion");
  const KeyFrameId keyframe = map_.add_keyframe(frame);
  map_.keyframe(keyframe).submap = submap;
  ++counts_.keyframes_made;
  if (calibrator_) calibrator_->add(map, keyframe);
  drop_moving_features(keyframe);
  if (!points_wait) make_points_from_depth(keyframe);
  for (const MapPointId point : map_.keyframe(keyframe).frame.map_points)
    if (point.valid()) map_.update_point(point);
  link(keyframe);
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
  link(keyframe);
  return keyframe;
}

void LocalMapper::link(KeyFrameId keyframe) {
  map_.update_covisibility(keyframe);
  if (map_.keyframe(keyframe).parent.valid()) return;
  // A keyframe without covisible neighbours (pose from odometry) becomes a child of the latest keyframe of its submap.
  const std::vector<KeyFrameId> by_age = map_.keyframes_by_age();
  const std::uint32_t submap = map_.keyframe(keyframe).submap;
  const auto last = std::find_if(by_age.rbegin() + 1, by_age.rend(),
                                 [&](KeyFrameId id) { return map_.keyframe(id).submap == submap; });
  if (last != by_age.rend()) map_.set_parent(keyframe, *last);
}

std::vector<KeyFrameId> LocalMapper::refine(KeyFrameId keyframe, StageTimes& times) {
  stop_ = false;
  {
    const StageTimer timer(times, "mapping: points");
    {
      const MapLock map(map_, mutex_);
      if (map->find_keyframe(keyframe) == nullptr) return {};
      if (calibrator_) disparities_changed_ = calibrator_->correct(map) || disparities_changed_;
      // Its mask may have arrived since it was inserted.
      for (const MapPointId point : drop_moving_features(keyframe)) drop_weak_point(point);
      make_points_from_depth(keyframe);
      remove_moving_points();
      remove_weak_points(keyframe);
    }
    triangulate_points(keyframe);
  }
  {
    const std::lock_guard lock(mutex_);
    if (map_.keyframes().size() < 2) return {};
  }
  {
    const StageTimer timer(times, "mapping: fusion");
    fuse_with_neighbours(keyframe);
  }
  {
    const StageTimer timer(times, "mapping: bundle adjustment");
    adjust_bundle(keyframe);
  }
  if (calibrator_) {
    const StageTimer timer(times, "mapping: pair calibration");
    calibrator_->learn(keyframe);
  }
  const StageTimer timer(times, "mapping: culling");
  const std::lock_guard lock(mutex_);
  std::vector<KeyFrameId> removed = remove_redundant_keyframes(keyframe);
  map_.invalidate_copies();
  return removed;
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

std::vector<MapPointId> LocalMapper::drop_moving_features(KeyFrameId id) {
  std::vector<MapPointId> dropped;
  const Frame& frame = map_.keyframe(id).frame;
  for (std::uint32_t i = 0; i < frame.size(); ++i) {
    const MapPointId point = frame.map_points[i];
    if (!point.valid() || is_static(frame, i)) continue;
    map_.remove_observation(point, id);
    dropped.push_back(point);
  }
  return dropped;
}

void LocalMapper::drop_weak_point(MapPointId point) {
  if (features_have_depth(map_.sensor())) return;
  // After a contradicting view, two other observations do not confirm a point, and one does not determine it.
  constexpr std::size_t required = 3;
  const MapPoint* left = map_.find_point(point);
  if (left == nullptr || left->observations.size() >= required) return;
  map_.remove_point(point);
  ++counts_.points_removed;
}

void LocalMapper::remove_moving_points() {
  std::vector<MapPointId> moving;
  map_.points().for_each([&](MapPointId id, const MapPoint& point) {
    if (point.static_log_odds < static_cast<float>(settings_.moving_log_odds)) moving.push_back(id);
  });
  for (const MapPointId id : moving) map_.remove_point(id);
  counts_.points_moving += moving.size();
}

void LocalMapper::remove_weak_points(KeyFrameId id) {
  const std::uint64_t now = map_.keyframe(id).sequence;
  // A triangulated point begins with two observations; one that no third keyframe confirms was a wrong match, or moved
  // (Mur-Artal et al. 2015, section VI-B). Depth counts as another view.
  const bool has_depth = features_have_depth(map_.sensor());
  const std::size_t required = has_depth ? 2 : 3;
  const bool can_be_confirmed = map_.keyframes().size() >= required;
  std::erase_if(recent_points_, [&](MapPointId point_id) {
    const MapPoint* point = map_.find_point(point_id);
    if (point == nullptr) return true;
    // Later keyframes may have created points while this one waited for its mask, by an older mask that shows people at
    // an earlier position: such points need a second observation as evidence that they are static.
    const bool is_later = point->created_at > now;
    if (is_later && (!has_depth || !expects_masks_)) return false;
    const std::uint64_t age = now - std::min(now, point->created_at);
    const bool rarely_found = point->found_ratio() < static_cast<float>(settings_.weak_found_ratio);
    const bool is_due = is_later || age >= (has_depth ? 2U : 1U);
    const bool unconfirmed = can_be_confirmed && is_due && point->observations.size() < required;
    if (rarely_found || unconfirmed) {
      map_.remove_point(point_id);
      ++counts_.points_removed;
      return true;
    }
    return is_later || age >= static_cast<std::uint64_t>(settings_.probation_keyframes);
  });
}

namespace {

/// Points that a keyframe observes.
struct SeenPoints {
  int all = 0;
  int redundant = 0;                 ///< three other keyframes observe them at the same or a finer scale
  float redundant_found_sum = 0.0F;  ///< sum of the found ratios of these
  std::vector<float> found;          ///< found ratios of the others
};

/// With a `limit` [m], only features with depth up to it count.
SeenPoints seen_points(const Map& map, KeyFrameId id, std::optional<float> limit) {
  constexpr int enough = 3;
  const Frame& frame = map.keyframe(id).frame;
  SeenPoints seen;
  for (std::uint32_t feature = 0; feature < frame.size(); ++feature) {
    if (!frame.map_points[feature].valid()) continue;
    if (limit && (!frame.has_depth(feature) || frame.depth[feature] > *limit)) continue;
    ++seen.all;
    const MapPoint& point = map.point(frame.map_points[feature]);
    int others = 0;
    for (const Observation& observation : point.observations) {
      if (observation.keyframe == id) continue;
      const auto& octave = map.keyframe(observation.keyframe).frame.features.octave;
      if (octave[observation.feature] <= frame.features.octave[feature] + 1 && ++others >= enough) break;
    }
    if (others >= enough) {
      ++seen.redundant;
      seen.redundant_found_sum += point.found_ratio();
    } else {
      seen.found.push_back(point.found_ratio());
    }
  }
  return seen;
}

/// Leaves out points that are not redundant and found less often than `share` of the mean of those that are: tracking
/// does without them. A share of that mean, because people hide all points of a room alike.
void leave_out_rarely_found(SeenPoints& seen, double share) {
  if (seen.redundant == 0) return;
  const float limit = static_cast<float>(share) * seen.redundant_found_sum / static_cast<float>(seen.redundant);
  seen.all -= static_cast<int>(std::count_if(seen.found.begin(), seen.found.end(), [&](float f) { return f < limit; }));
}

}  // namespace

std::vector<KeyFrameId> LocalMapper::remove_redundant_keyframes(KeyFrameId id) {
  // Redundancy is measured by close points (Mur-Artal and Tardos 2017, section III-D). A keyframe with few of them,
  // such as people before a far wall, would never be redundant; therefore all its points count once it is not among the
  // recent keyframes, whose depth the filters compare. Nor does then one stay for the sake of points at the outlines of
  // people, which are hardly ever found again: in a room the number of keyframes has to level off.
  constexpr std::uint64_t recent = 200;
  std::vector<KeyFrameId> removed;
  if (settings_.redundant_share >= 1.0) return removed;
  const std::vector<CovisibilityEdge> neighbours = map_.keyframe(id).covisible;
  const std::uint64_t sequence = map_.keyframe(id).sequence;
  const bool has_depth = features_have_depth(map_.sensor());
  for (const CovisibilityEdge& edge : neighbours) {
    const KeyFrame& keyframe = map_.keyframe(edge.keyframe);
    if (!keyframe.parent.valid() || !keyframe.loop_edges.empty()) continue;
    if (keyframe.sequence > sequence) continue;  // not refined yet
    std::optional<float> close;
    if (has_depth) close = static_cast<float>(close_depth_factor_ * keyframe.frame.camera->baseline);
    SeenPoints seen = seen_points(map_, edge.keyframe, close);
    if (keyframe.sequence + recent < sequence) {
      if (has_depth && seen.all < settings_.minimum_depth_points) seen = seen_points(map_, edge.keyframe, std::nullopt);
      leave_out_rarely_found(seen, settings_.weak_found_ratio);
    }
    if (seen.redundant <= settings_.redundant_share * seen.all) continue;
    map_.remove_keyframe(edge.keyframe);
    removed.push_back(edge.keyframe);
    ++counts_.keyframes_removed;
  }
  return removed;
}

}  // namespace holdfast
