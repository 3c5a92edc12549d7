// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "holdfast/matching/frame_features.hpp"
#include "mapping_steps.hpp"

namespace holdfast {

std::vector<MapPointId> drop_moving_features(Map& map, KeyFrameId id) {
  std::vector<MapPointId> dropped;
  const Frame& frame = map.keyframe(id).frame;
  for (std::uint32_t i = 0; i < frame.size(); ++i) {
    const MapPointId point = frame.map_points[i];
    if (!point.valid() || is_static(frame, i)) continue;
    map.remove_observation(point, id);
    dropped.push_back(point);
  }
  return dropped;
}

bool drop_weak_point(Map& map, MapPointId point) {
  if (features_have_depth(map.sensor())) return false;
  // After a contradicting view, two other observations do not confirm a point, and one does not determine it.
  constexpr std::size_t required = 3;
  const MapPoint* left = map.find_point(point);
  if (left == nullptr || left->observations.size() >= required) return false;
  map.remove_point(point);
  return true;
}

std::size_t remove_moving_points(Map& map, double moving_log_odds) {
  std::vector<MapPointId> moving;
  map.points().for_each([&](MapPointId id, const MapPoint& point) {
    if (point.static_log_odds < static_cast<float>(moving_log_odds)) moving.push_back(id);
  });
  for (const MapPointId id : moving) map.remove_point(id);
  return moving.size();
}

std::size_t remove_weak_points(Map& map, KeyFrameId id, const MappingSettings& settings, bool expects_masks,
                               std::vector<MapPointId>& recent_points) {
  const std::uint64_t now = map.keyframe(id).sequence;
  // A triangulated point begins with two observations; one that no third keyframe confirms was a wrong match, or moved
  // (Mur-Artal et al. 2015, section VI-B). Depth counts as another view.
  const bool has_depth = features_have_depth(map.sensor());
  const std::size_t required = has_depth ? 2 : 3;
  const bool can_be_confirmed = map.keyframes().size() >= required;
  std::size_t removed = 0;
  std::erase_if(recent_points, [&](MapPointId point_id) {
    const MapPoint* point = map.find_point(point_id);
    if (point == nullptr) return true;
    // Later keyframes may have created points while this one waited for its mask, by an older mask that shows people at
    // an earlier position: such points need a second observation as evidence that they are static.
    const bool is_later = point->created_at > now;
    if (is_later && (!has_depth || !expects_masks)) return false;
    const std::uint64_t age = now - std::min(now, point->created_at);
    const bool rarely_found = point->found_ratio() < static_cast<float>(settings.weak_found_ratio);
    const bool is_due = is_later || age >= (has_depth ? 2U : 1U);
    const bool unconfirmed = can_be_confirmed && is_due && point->observations.size() < required;
    if (rarely_found || unconfirmed) {
      map.remove_point(point_id);
      ++removed;
      return true;
    }
    return is_later || age >= static_cast<std::uint64_t>(settings.probation_keyframes);
  });
  return removed;
}

namespace {

/// Points that a keyframe observes.
struct SeenPoints {
  int all = 0;
  int redundant = 0;                 ///< three other keyframes observe them at the same or a finer scale
  float redundant_found_sum = 0.0F;  ///< sum of the found ratios of these
  std::vector<float> found;          ///< found ratios of the others
};

/// Whether three other keyframes observe the point of a feature at the same or a finer scale.
bool is_point_redundant(const Map& map, KeyFrameId id, std::uint32_t feature) {
  constexpr int enough = 3;
  const Frame& frame = map.keyframe(id).frame;
  const MapPoint& point = map.point(frame.map_points[feature]);
  if (static_cast<int>(point.observations.size()) <= enough) return false;
  int others = 0;
  for (const Observation& observation : point.observations) {
    if (observation.keyframe == id) continue;
    const auto& octave = map.keyframe(observation.keyframe).frame.features.octave;
    if (octave[observation.feature] <= frame.features.octave[feature] + 1 && ++others >= enough) return true;
  }
  return false;
}

/// With a `limit` [m], only features with depth up to it count.
SeenPoints seen_points(const Map& map, KeyFrameId id, std::optional<float> limit) {
  const Frame& frame = map.keyframe(id).frame;
  SeenPoints seen;
  for (std::uint32_t feature = 0; feature < frame.size(); ++feature) {
    if (!frame.map_points[feature].valid()) continue;
    if (limit && (!frame.has_depth(feature) || frame.depth[feature] > *limit)) continue;
    ++seen.all;
    const float found_ratio = map.point(frame.map_points[feature]).found_ratio();
    if (is_point_redundant(map, id, feature)) {
      ++seen.redundant;
      seen.redundant_found_sum += found_ratio;
    } else {
      seen.found.push_back(found_ratio);
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

/// Number of later keyframes after which a keyframe is old.
constexpr std::uint64_t recent = 200;

bool is_old(const KeyFrame& keyframe, std::uint64_t now) { return keyframe.sequence + recent < now; }

/// The neighbours of a keyframe, and of the old keyframes the one whose turn it is: one with few points is nobody's
/// neighbour.
std::vector<KeyFrameId> candidates(const Map& map, const KeyFrame& keyframe) {
  std::vector<KeyFrameId> result;
  for (const CovisibilityEdge& edge : keyframe.covisible) result.push_back(edge.keyframe);
  const std::vector<KeyFrameId> by_age = map.keyframes_by_age();
  const auto end = std::find_if(by_age.begin(), by_age.end(),
                                [&](KeyFrameId id) { return !is_old(map.keyframe(id), keyframe.sequence); });
  if (end == by_age.begin()) return result;
  const KeyFrameId in_turn = by_age[keyframe.sequence % static_cast<std::uint64_t>(end - by_age.begin())];
  if (std::find(result.begin(), result.end(), in_turn) == result.end()) result.push_back(in_turn);
  return result;
}

bool are_redundant(const SeenPoints& seen, const MappingSettings& settings) {
  return seen.redundant > settings.redundant_share * seen.all;
}

/// Whether the points of an old keyframe are redundant, or so few are not that it adds little to the map. Close ones
/// count, up to `limit`, if there are enough of them.
bool is_old_redundant(const Map& map, KeyFrameId id, std::optional<float> limit, const MappingSettings& settings) {
  constexpr double little = 0.02;  // of its features
  SeenPoints all = seen_points(map, id, std::nullopt);
  leave_out_rarely_found(all, settings.weak_found_ratio);
  if (all.all - all.redundant < little * static_cast<double>(map.keyframe(id).frame.size())) return true;
  if (!limit) return are_redundant(all, settings);
  SeenPoints close = seen_points(map, id, limit);
  if (close.all < settings.minimum_depth_points) return are_redundant(all, settings);
  leave_out_rarely_found(close, settings.weak_found_ratio);
  return are_redundant(close, settings);
}

}  // namespace

std::vector<KeyFrameId> remove_redundant_keyframes(Map& map, KeyFrameId id, const MappingSettings& settings,
                                                   double close_depth_factor) {
  // Redundancy is measured by close points (Mur-Artal and Tardos 2017, section III-D). A keyframe with few of them,
  // such as people before a far wall, would never be redundant; therefore all its points count once it is not among the
  // recent keyframes, whose depth the filters compare. Nor does then one stay for the sake of points at the outlines of
  // people, which are hardly ever found again, or of the few that a crowd left of its view: in a room the number of
  // keyframes has to level off.
  std::vector<KeyFrameId> removed;
  if (settings.redundant_share >= 1.0) return removed;
  const std::uint64_t sequence = map.keyframe(id).sequence;
  for (const KeyFrameId candidate : candidates(map, map.keyframe(id))) {
    const KeyFrame& keyframe = map.keyframe(candidate);
    if (!keyframe.parent.valid() || !keyframe.loop_edges.empty()) continue;
    if (keyframe.sequence > sequence) continue;  // not refined yet
    std::optional<float> close;
    if (features_have_depth(map.sensor()))
      close = static_cast<float>(close_depth_factor * keyframe.frame.camera->baseline);
    const bool is_redundant = is_old(keyframe, sequence) ? is_old_redundant(map, candidate, close, settings)
                                                         : are_redundant(seen_points(map, candidate, close), settings);
    if (!is_redundant) continue;
    map.remove_keyframe(candidate);
    removed.push_back(candidate);
  }
  return removed;
}

}  // namespace holdfast
