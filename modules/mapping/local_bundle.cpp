// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdint>
#include <mutex>
#include <numeric>
#include <optional>
#include <utility>

#include "holdfast/geometry/se3.hpp"
#include "holdfast/interfaces/frame_observations.hpp"
#include "holdfast/matching/point_block.hpp"
#include "mapping_steps.hpp"

namespace holdfast {

namespace {

/// A bundle problem, and what its entries stand for in the map.
struct LocalBundle {
  BundleProblem problem;
  std::vector<KeyFrameId> keyframes;  // of the poses, free ones first
  std::vector<MapPointId> points;
  std::vector<std::pair<MapPointId, KeyFrameId>> observations;
  // For each free keyframe, the number of its points that another keyframe observes.
  std::vector<int> shared_points;
};

std::vector<KeyFrameId> free_keyframes(const Map& map, KeyFrameId id, bool frees_latest, int max_neighbours) {
  std::vector<KeyFrameId> keyframes = {id};
  if (!frees_latest) {
    for (const KeyFrameId neighbour : map.best_covisible(id, max_neighbours)) keyframes.push_back(neighbour);
    return keyframes;
  }
  constexpr std::size_t max_count = 40;
  const std::vector<KeyFrameId> by_age = map.keyframes_by_age();
  for (auto other = by_age.rbegin(); other != by_age.rend() && keyframes.size() < max_count; ++other)
    if (*other != id && map.keyframe(*other).submap == map.keyframe(id).submap) keyframes.push_back(*other);
  return keyframes;
}

/// Fixes the gauge: if no keyframe is fixed, fixes the oldest.
void fix_gauge(const Map& map, LocalBundle& bundle) {
  std::vector<BundleProblem::Pose>& poses = bundle.problem.poses;
  if (std::any_of(poses.begin(), poses.end(), [](const auto& pose) { return pose.fixed; })) return;
  const auto oldest =
      std::min_element(bundle.keyframes.begin(), bundle.keyframes.end(),
                       [&](KeyFrameId a, KeyFrameId b) { return map.keyframe(a).sequence < map.keyframe(b).sequence; });
  poses[static_cast<std::size_t>(oldest - bundle.keyframes.begin())].fixed = true;
}

/// Free are the given keyframes, except `held`, and all points that they observe; other keyframes that observe these
/// points are fixed.
LocalBundle build_bundle(const Map& map, std::vector<KeyFrameId> free, const std::vector<KeyFrameId>& held,
                         const MappingSettings& settings) {
  LocalBundle bundle;
  bundle.keyframes = std::move(free);
  std::vector<KeyFrameId>& keyframes = bundle.keyframes;
  BundleProblem& problem = bundle.problem;
  const std::size_t moving = keyframes.size();
  std::vector<std::int32_t> pose_of_slot(map.keyframes().slot_count(), -1);
  for (std::size_t i = 0; i < moving; ++i) pose_of_slot[keyframes[i].slot] = static_cast<std::int32_t>(i);
  bundle.points = points_seen_by(map, keyframes);
  bundle.shared_points.assign(moving, 0);
  problem.camera = map.keyframe(keyframes.front()).frame.camera.get();
  problem.robust_iterations = settings.bundle_robust_iterations;
  problem.final_iterations = settings.bundle_final_iterations;
  // Where no depth is measured, motion along a surface and a turn are told apart by little, and the cost hardly falls
  // on the way from one to the other. What a solver's own tolerance leaves of it adds up from keyframe to keyframe.
  constexpr double one_camera_tolerance = 1e-5;
  if (!features_have_depth(map.sensor())) problem.function_tolerance = one_camera_tolerance;
  for (std::uint32_t p = 0; p < bundle.points.size(); ++p) {
    const MapPoint& point = map.point(bundle.points[p]);
    problem.points.push_back(point.position);
    const bool is_shared = point.observations.size() > 1;
    for (const Observation& observation : point.observations) {
      std::int32_t& pose = pose_of_slot[observation.keyframe.slot];
      if (pose < 0) {
        pose = static_cast<std::int32_t>(keyframes.size());
        keyframes.push_back(observation.keyframe);
      }
      if (is_shared && static_cast<std::size_t>(pose) < moving) ++bundle.shared_points[static_cast<std::size_t>(pose)];
      problem.observations.push_back(bundle_observation(map.keyframe(observation.keyframe).frame, observation.feature,
                                                        static_cast<std::uint32_t>(pose), p));
      bundle.observations.emplace_back(bundle.points[p], observation.keyframe);
    }
  }
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    const KeyFrame& keyframe = map.keyframe(keyframes[i]);
    const bool is_held = std::find(held.begin(), held.end(), keyframes[i]) != held.end();
    problem.poses.push_back({keyframe.frame.T_camera_world, i >= moving || keyframe.sequence == 0 || is_held});
  }
  fix_gauge(map, bundle);
  return bundle;
}

constexpr int few_points = 2 * minimum_shared_points;  // that determine no pose against inertial measurements

/// For each free keyframe, the number of points that its group shares with keyframes outside. Keyframes are in one
/// group where few_points tie them to each other: however many these are, a group moves as a whole.
std::vector<int> count_ties_of_groups(const LocalBundle& bundle) {
  const std::vector<BundleProblem::Pose>& poses = bundle.problem.poses;
  std::vector<std::vector<std::size_t>> poses_of_point(bundle.points.size());
  for (const BundleProblem::Observation& observation : bundle.problem.observations)
    poses_of_point[observation.point].push_back(observation.pose);
  const std::size_t free = bundle.shared_points.size();
  std::vector<std::size_t> group(poses.size());
  std::iota(group.begin(), group.end(), std::size_t{0});
  std::vector<int> common(free * free, 0);
  const auto join = [&group](std::size_t kept, std::size_t joined) {
    std::replace(group.begin(), group.end(), joined, kept);
  };
  for (const std::vector<std::size_t>& seen_by : poses_of_point)
    for (const std::size_t a : seen_by)
      for (const std::size_t b : seen_by)
        if (a < b && !poses[a].fixed && !poses[b].fixed && ++common[a * free + b] == few_points)
          join(group[a], group[b]);
  std::vector<int> ties(free, 0);
  for (const std::vector<std::size_t>& seen_by : poses_of_point)
    for (std::size_t i = 0; i < free; ++i) {
      const auto is_inside = [&](std::size_t pose) { return group[pose] == group[i]; };
      if (std::any_of(seen_by.begin(), seen_by.end(), is_inside) &&
          !std::all_of(seen_by.begin(), seen_by.end(), is_inside))
        ++ties[i];
    }
  return ties;
}

/// The keyframes that few points constrain and whose adjusted poses contradict inertial measurements, with those that
/// depend on them. Keyframes behind a view that people hid may share a handful of points with the rest of the map, and
/// many with each other; such points move all of them by decimetres.
std::vector<KeyFrameId> find_diverged(const LocalBundle& bundle, const Map& map) {
  std::vector<std::size_t> by_age(bundle.shared_points.size());
  std::iota(by_age.begin(), by_age.end(), std::size_t{0});
  const auto keyframe = [&](std::size_t i) -> const KeyFrame& { return map.keyframe(bundle.keyframes[i]); };
  const auto is_predicted = [&](std::size_t i) { return inertial_divergence(keyframe(i).frame) > 0.0; };
  if (std::none_of(by_age.begin(), by_age.end(), is_predicted)) return {};
  std::sort(by_age.begin(), by_age.end(),
            [&](std::size_t a, std::size_t b) { return keyframe(a).sequence < keyframe(b).sequence; });
  const std::vector<int> ties = count_ties_of_groups(bundle);
  std::vector<KeyFrameId> diverged;
  for (const std::size_t i : by_age) {
    const double limit = inertial_divergence(keyframe(i).frame);
    const KeyFrameId parent = keyframe(i).parent;
    if (bundle.problem.poses[i].fixed || limit <= 0.0 || !parent.valid() || ties[i] >= few_points) continue;
    Eigen::Isometry3d motion = bundle.problem.poses[i].T_camera_world * keyframe(i).frame.T_world_camera();
    const auto found = std::find(bundle.keyframes.begin(), bundle.keyframes.end(), parent);
    if (found != bundle.keyframes.end()) {
      const auto p = static_cast<std::size_t>(found - bundle.keyframes.begin());
      motion = bundle.problem.poses[i].T_camera_world * bundle.problem.poses[p].T_camera_world.inverse() *
               keyframe(p).frame.T_camera_world * keyframe(i).frame.T_world_camera();
    }
    const bool depends = std::find(diverged.begin(), diverged.end(), parent) != diverged.end();
    if (depends || geometry::exceeds(motion, limit, limit)) diverged.push_back(bundle.keyframes[i]);
  }
  return diverged;
}

void apply_poses(const LocalBundle& bundle, Map& map) {
  for (std::size_t i = 0; i < bundle.keyframes.size(); ++i) {
    const BundleProblem::Pose& adjusted = bundle.problem.poses[i];
    if (adjusted.fixed) continue;
    Eigen::Isometry3d& pose = map.keyframe(bundle.keyframes[i]).frame.T_camera_world;
    const bool has_diverged =
        bundle.shared_points[i] < minimum_shared_points &&
        geometry::exceeds(adjusted.T_camera_world * pose.inverse(), local_divergence, local_divergence);
    if (!has_diverged) pose = adjusted.T_camera_world;
  }
}

/// Ids stay valid while the structure mutex is held: other threads may only add.
BundleRemovals apply_bundle(const LocalBundle& bundle, Map& map) {
  apply_poses(bundle, map);
  for (std::size_t p = 0; p < bundle.points.size(); ++p)
    map.point(bundle.points[p]).position = bundle.problem.points[p];
  BundleRemovals removals;
  for (std::size_t o = 0; o < bundle.observations.size(); ++o) {
    if (!bundle.problem.observations[o].outlier) continue;
    const auto& [point, keyframe] = bundle.observations[o];
    if (map.find_point(point) == nullptr) continue;
    map.remove_observation(point, keyframe);
    removals.points += drop_weak_point(map, point) ? 1 : 0;
    ++removals.observations;
  }
  for (const MapPointId point : bundle.points)
    if (map.find_point(point) != nullptr) map.update_point_geometry(point);
  map.invalidate_copies();
  return removals;
}

}  // namespace

BundleRemovals adjust_bundle(Map& map, MapMutex& mutex, KeyFrameId keyframe, bool frees_latest,
                             const MappingSettings& settings, Optimizer& optimizer, const std::atomic<bool>& stop) {
  const auto solve = [&](const std::vector<KeyFrameId>& held) -> std::optional<LocalBundle> {
    LocalBundle bundle;
    {
      const std::lock_guard lock(mutex);
      const int max_neighbours = settings.bundle_keyframes - 1;
      bundle = build_bundle(map, free_keyframes(map, keyframe, frees_latest, max_neighbours), held, settings);
    }
    if (!optimizer.optimize_bundle(bundle.problem, stop).usable) return std::nullopt;
    return bundle;
  };
  std::optional<LocalBundle> bundle = solve({});
  if (!bundle) return {};
  const std::vector<KeyFrameId> diverged = [&] {
    const std::lock_guard lock(mutex);
    return find_diverged(*bundle, map);
  }();
  if (!diverged.empty()) bundle = solve(diverged);
  if (!bundle) return {};
  const std::lock_guard lock(mutex);
  return apply_bundle(*bundle, map);
}

}  // namespace holdfast
