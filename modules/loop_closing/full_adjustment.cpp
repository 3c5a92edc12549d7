// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/loop_closing/full_adjustment.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>

#include "holdfast/core/median.hpp"
#include "holdfast/interfaces/frame_observations.hpp"
#include "map_motion.hpp"
#include "piece_set.hpp"
#include "weak_ties.hpp"

namespace holdfast {
namespace {

std::int64_t now_in_nanoseconds() {
  using std::chrono::duration_cast, std::chrono::nanoseconds, std::chrono::steady_clock;
  return duration_cast<nanoseconds>(steady_clock::now().time_since_epoch()).count();
}

/// By keyframe slot, number of points that another keyframe observes.
std::vector<int> count_shared_points(const Map& map) {
  std::vector<int> shared(map.keyframes().slot_count(), 0);
  map.points().for_each([&](MapPointId, const MapPoint& point) {
    if (point.observations.size() < 2) return;
    for (const Observation& observation : point.observations) ++shared[observation.keyframe.slot];
  });
  return shared;
}

/// By keyframe slot, the keyframes before and after it in time to which inertial measurements link it.
using Neighbours = std::vector<std::array<KeyFrameId, 2>>;

Neighbours find_neighbours(const Map& map, const std::vector<KeyFrameId>& keyframes,
                           const std::vector<InertialHistory::Link>& links) {
  Neighbours neighbours(map.keyframes().slot_count());
  for (const InertialHistory::Link& link : links) {
    neighbours[keyframes[link.first].slot][1] = keyframes[link.second];
    neighbours[keyframes[link.second].slot][0] = keyframes[link.first];
  }
  return neighbours;
}

bool has_link(const std::array<KeyFrameId, 2>& neighbours) { return neighbours[0].valid() || neighbours[1].valid(); }

/// The keyframes with enough observations to be adjusted, or with an inertial link, oldest first; the first one of
/// every submap fixes its gauge and is always included.
std::vector<KeyFrameId> placeable_keyframes(const Map& map, const Neighbours& neighbours) {
  const std::vector<int> shared = count_shared_points(map);
  std::vector<KeyFrameId> keyframes = map.keyframes_by_age();
  SubmapSet submaps;
  std::erase_if(keyframes, [&](KeyFrameId id) {
    const bool is_first = submaps.add(map.keyframe(id).submap);
    return !is_first && shared[id.slot] < minimum_shared_points && !has_link(neighbours[id.slot]);
  });
  return keyframes;
}

// In a degenerate configuration, more points than the minimum constrain poses weakly as well.
constexpr int few_points = 4 * minimum_shared_points;

/// By keyframe slot, the island of each keyframe: those that covisibility joins, by as many points as an adjustment
/// requires or `min_points`, or a link. Islands are named by the slot of their oldest keyframe.
std::vector<std::uint32_t> find_islands(const Map& map, const Neighbours& neighbours,
                                        int min_points = minimum_shared_points) {
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> island(map.keyframes().slot_count(), none);
  std::vector<KeyFrameId> reached;
  for (const KeyFrameId first : map.keyframes_by_age()) {
    if (island[first.slot] != none) continue;
    island[first.slot] = first.slot;
    reached.assign(1, first);
    while (!reached.empty()) {
      const KeyFrameId from = reached.back();
      reached.pop_back();
      const auto reach = [&](KeyFrameId id) {
        if (island[id.slot] != none) return;
        island[id.slot] = first.slot;
        reached.push_back(id);
      };
      for (const CovisibilityEdge& edge : map.keyframe(from).covisible)
        if (edge.weight >= min_points) reach(edge.keyframe);
      for (const KeyFrameId id : neighbours[from.slot])
        if (id.valid()) reach(id);
    }
  }
  return island;
}

/// By slot, whether a keyframe is the oldest of an island of several that shares hardly a point with the others, as
/// behind a view that inertial measurements bridged: without a link nothing else fixes the gauge of these.
std::vector<std::uint8_t> find_island_holders(const Map& map, const Neighbours& neighbours) {
  const std::vector<std::uint32_t> island = find_islands(map, neighbours);
  std::vector<int> keyframes(island.size(), 0), links(island.size(), 0);
  for (const KeyFrameId id : map.keyframes_by_age()) ++keyframes[island[id.slot]];
  map.points().for_each([&](MapPointId, const MapPoint& point) {
    const auto is_other = [&](const Observation& observation) {
      return island[observation.keyframe.slot] != island[point.observations.front().keyframe.slot];
    };
    if (std::none_of(point.observations.begin(), point.observations.end(), is_other)) return;
    for (const Observation& observation : point.observations) ++links[island[observation.keyframe.slot]];
  });
  std::vector<std::uint8_t> holds(island.size(), 0);
  for (const KeyFrameId id : map.keyframes_by_age())
    holds[id.slot] = island[id.slot] == id.slot && keyframes[id.slot] > 1 && links[id.slot] < few_points ? 1 : 0;
  return holds;
}

/// Of the solution that sorts weak ties, whose deviations are centimetres: the one with the right ties begins there.
constexpr double sorting_tolerance = 1e-5;

/// Calls function(index) for 0 ... count - 1 and releases the map's lock after every 1000 calls.
template <class Function>
void in_portions(MapMutex& mutex, std::size_t count, Function&& function) {
  constexpr std::size_t portion = 1000;
  for (std::size_t begin = 0; begin < count; begin += portion) {
    const std::lock_guard lock(mutex);
    for (std::size_t i = begin; i < std::min(count, begin + portion); ++i) function(i);
  }
}

/// By pose, how much larger a solution makes the surroundings of its keyframe than they are in the map: the median
/// ratio of the distances of its points. Nothing holds the unit of one camera's map, which changes from place to place,
/// and with it the frames that are relative to a keyframe. Empty where observations have depth or factors hold the
/// unit.
std::vector<double> scale_changes(const Map& map, const BundleProblem& solution, std::span<const KeyFrameId> keyframes,
                                  std::span<const MapPointId> points) {
  const auto has_depth = [](const BundleProblem::Observation& seen) { return !std::isnan(seen.right_x); };
  if (!solution.factors.empty() || std::any_of(solution.observations.begin(), solution.observations.end(), has_depth))
    return {};
  constexpr std::size_t fewest_ratios = 10;
  std::vector<std::vector<double>> ratios(keyframes.size());
  std::vector<double> all;
  for (const BundleProblem::Observation& seen : solution.observations) {
    const KeyFrame* keyframe = map.find_keyframe(keyframes[seen.pose]);
    const MapPoint* point = map.find_point(points[seen.point]);
    if (seen.outlier || keyframe == nullptr || point == nullptr) continue;
    const double before = (keyframe->frame.T_camera_world * point->position).norm();
    const double after = (solution.poses[seen.pose].T_camera_world * solution.points[seen.point]).norm();
    if (!(before > 0.0) || !(after > 0.0)) continue;
    ratios[seen.pose].push_back(after / before);
    all.push_back(after / before);
  }
  if (all.empty()) return {};
  std::vector<double> scales(keyframes.size(), upper_median(all));
  for (std::size_t i = 0; i < scales.size(); ++i)
    if (ratios[i].size() >= fewest_ratios) scales[i] = upper_median(ratios[i]);
  return scales;
}

}  // namespace

FullAdjustment::FullAdjustment(const LoopClosingSettings& settings, const SharedMap& shared, Optimizer& optimizer)
    : settings_(settings),
      map_(shared.map),
      map_mutex_(shared.mutex),
      structure_mutex_(shared.structure_mutex),
      optimizer_(optimizer) {}

void FullAdjustment::request_stop() {
  std::int64_t not_asked = 0;
  stop_time_.compare_exchange_strong(not_asked, now_in_nanoseconds());
  stop_ = true;
}

void FullAdjustment::cancel() {
  cancelled_ = true;  // first, because prepare() clears the request and then reads this flag
  request_stop();
}

void FullAdjustment::prepare() {
  std::unique_lock structure_lock(structure_mutex_);  // no correction is in progress
  stop_ = false;
  stop_time_ = 0;
  if (cancelled_) request_stop();
  if (inertia_ != nullptr) {
    structure_lock.unlock();
    find_links();
    structure_lock.lock();
  }
  summary_ = {};
  placed_keyframes_.clear();
  problem_ = {};
  points_.clear();
  problem_.robust_iterations = settings_.full_robust_iterations;
  problem_.final_iterations = settings_.full_final_iterations;
  problem_.function_tolerance = settings_.full_tolerance;

  const std::lock_guard lock(map_mutex_);
  drop_stale_links();
  copy_poses();
  copy_points();
  if (!links_.empty()) add_links();
}

/// Preintegrates the run without a lock, because tracking waits for the map.
void FullAdjustment::find_links() {
  std::vector<double> timestamps;
  {
    const std::lock_guard lock(map_mutex_);
    linkable_ = map_.keyframes_by_age();
    linked_submap_ = inertia_->submap();
    timestamps = linkable_stamps(map_, linkable_, *inertia_);
  }
  links_ = inertia_->links(timestamps);
}

/// Of keyframes that were removed meanwhile, or have become part of another submap.
void FullAdjustment::drop_stale_links() {
  const auto is_stale = [&](std::size_t index) {
    const KeyFrame* keyframe = map_.find_keyframe(linkable_[index]);
    return keyframe == nullptr || keyframe->submap != linked_submap_ || inertia_->submap() != linked_submap_;
  };
  std::erase_if(links_,
                [&](const InertialHistory::Link& link) { return is_stale(link.first) || is_stale(link.second); });
}

void FullAdjustment::add_links() {
  std::vector<std::size_t> pose_of_slot(map_.keyframes().slot_count());
  for (std::size_t i = 0; i < keyframes_.size(); ++i) pose_of_slot[keyframes_[i].slot] = i;
  for (InertialHistory::Link& link : links_) {
    link.first = pose_of_slot[linkable_[link.first].slot];
    link.second = pose_of_slot[linkable_[link.second].slot];
  }
  if (const std::optional<MapInertia> estimates = inertia_->estimates())
    is_linked_ = add_inertial_factors(problem_, links_, *estimates);
  links_ = {};
}

void FullAdjustment::copy_poses() {
  const Neighbours neighbours = find_neighbours(map_, linkable_, links_);
  keyframes_ = placeable_keyframes(map_, neighbours);
  is_linked_.assign(keyframes_.size(), 0);
  is_fixed_without_links_.clear();
  const std::vector<std::uint8_t> holds = find_island_holders(map_, neighbours);
  const std::vector<std::uint8_t> holds_without_links =
      links_.empty() ? holds : find_island_holders(map_, Neighbours(neighbours.size()));
  cluster_.clear();
  if (!links_.empty()) {
    const auto clusters = find_islands(map_, Neighbours(neighbours.size()), 2 * minimum_shared_points);
    for (const KeyFrameId id : keyframes_) cluster_.push_back(clusters[id.slot]);
  }
  SubmapSet submaps;
  for (const KeyFrameId id : keyframes_) {
    const KeyFrame& keyframe = map_.keyframe(id);
    if (problem_.camera == nullptr) problem_.camera = keyframe.frame.camera.get();
    const bool holds_submap = submaps.add(keyframe.submap);
    problem_.poses.push_back({keyframe.frame.T_camera_world, holds_submap || holds[id.slot] != 0});
    is_fixed_without_links_.push_back(holds_submap || holds_without_links[id.slot] != 0 ? 1 : 0);
  }
}

void FullAdjustment::copy_points() {
  constexpr std::uint32_t left_out = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> pose_of_slot(map_.keyframes().slot_count(), left_out);
  for (std::uint32_t i = 0; i < keyframes_.size(); ++i) pose_of_slot[keyframes_[i].slot] = i;
  points_.reserve(map_.points().size());
  problem_.points.reserve(map_.points().size());
  map_.points().for_each([&](MapPointId id, const MapPoint& point) {
    const auto index = static_cast<std::uint32_t>(points_.size());
    points_.push_back(id);
    problem_.points.push_back(point.position);
    for (const Observation& observation : point.observations)
      if (pose_of_slot[observation.keyframe.slot] != left_out)
        problem_.observations.push_back(bundle_observation(map_.keyframe(observation.keyframe).frame,
                                                           observation.feature, pose_of_slot[observation.keyframe.slot],
                                                           index));
  });
  before_ = problem_.points;
}

void FullAdjustment::solve() {
  summary_.keyframes = static_cast<int>(problem_.poses.size());
  summary_.points = static_cast<int>(problem_.points.size());
  summary_.observations = static_cast<int>(problem_.observations.size());
  if (problem_.camera == nullptr) return;
  summary_.bundle = problem_.factors.empty() ? optimizer_.optimize_bundle(problem_, stop_) : solve_with_inertia();
  if (!summary_.bundle.usable && !stop_ && !problem_.factors.empty()) {
    problem_.factors = BundleFactors();
    is_linked_.assign(is_linked_.size(), 0);
    for (std::size_t i = 0; i < problem_.poses.size(); ++i) problem_.poses[i].fixed = is_fixed_without_links_[i] != 0;
    summary_.bundle = optimizer_.optimize_bundle(problem_, stop_);
  }
  summary_.seconds_per_iteration = summary_.bundle.seconds / std::max(1, summary_.bundle.iterations);
  if (const std::int64_t asked = stop_time_)
    summary_.stop_seconds = static_cast<double>(now_in_nanoseconds() - asked) * 1e-9;
}

/// The first solution, without weak ties, tells which of them are right. It stays if there is none with these.
BundleSummary FullAdjustment::solve_with_inertia() {
  WeakTies ties;
  if (const std::optional<MapInertia> estimates = inertia_->estimates()) ties.take_out(problem_, cluster_, *estimates);
  if (ties.empty()) return optimizer_.optimize_bundle(problem_, stop_);
  problem_.function_tolerance = std::max(settings_.full_tolerance, sorting_tolerance);
  const BundleSummary first = optimizer_.optimize_bundle(problem_, stop_);
  problem_.function_tolerance = settings_.full_tolerance;
  if (!first.usable || stop_) {
    ties.put_back_all(problem_);
    return first;
  }
  ties.put_back_agreeing(problem_);
  BundleSummary summary = optimizer_.optimize_bundle(problem_, stop_);
  const BundleSummary& solution = summary.usable ? summary : first;  // one that is not usable changes nothing
  summary.outliers = solution.outliers;
  summary.final_cost = solution.final_cost;
  summary.usable = true;
  summary.iterations += first.iterations;
  summary.seconds += first.seconds;
  summary.initial_cost = first.initial_cost;
  summary.outliers += static_cast<int>(ties.add_rejected(problem_));
  return summary;
}

FullAdjustmentSummary FullAdjustment::apply() {
  {
    const std::lock_guard structure_lock(structure_mutex_);
    summary_.stop_requested = stop_;
    if (summary_.bundle.usable && !summary_.stop_requested) change_map();
  }
  // Frees the copy, because the next adjustment may be far away.
  problem_ = BundleProblem();
  keyframes_ = std::vector<KeyFrameId>();
  linkable_ = std::vector<KeyFrameId>();
  points_ = std::vector<MapPointId>();
  before_ = std::vector<Eigen::Vector3d>();
  return summary_;
}

void FullAdjustment::change_map() {
  move_map();
  remove_outliers();
  in_portions(map_mutex_, points_.size(), [this](std::size_t i) {
    if (map_.find_point(points_[i]) != nullptr) map_.update_point_geometry(points_[i]);
  });
  if (!problem_.factors.empty()) inertia_->set_gravity(problem_.factors.gravity, linked_submap_);
  const std::lock_guard lock(map_mutex_);
  map_.invalidate_copies();
  summary_.applied = true;
}

void FullAdjustment::move_map() {
  std::vector<Eigen::Isometry3d> poses;
  for (const BundleProblem::Pose& pose : problem_.poses) poses.push_back(pose.T_camera_world);

  // Update poses and points under one lock so that readers never see a mixed state.
  const std::lock_guard lock(map_mutex_);
  const std::vector<int> shared = count_shared_points(map_);
  std::vector<std::uint8_t> is_weak;
  for (std::size_t i = 0; i < keyframes_.size(); ++i)
    is_weak.push_back(shared[keyframes_[i].slot] < few_points && is_linked_[i] == 0 ? 1 : 0);
  const MapMotion motion(map_, keyframes_, poses, scale_changes(map_, problem_, keyframes_, points_), is_weak);
  summary_.keyframes_carried = motion.move_keyframes(map_);
  for (std::size_t i = 0; i < keyframes_.size() && inertia_ != nullptr; ++i) {
    const KeyFrame* keyframe = map_.find_keyframe(keyframes_[i]);
    if (keyframe == nullptr || problem_.poses[i].fixed) continue;
    if (keyframe->frame.T_camera_world.matrix() == poses[i].matrix())
      placed_keyframes_.push_back(keyframe->frame.timestamp);
  }
  keep_motions(poses);
  std::vector<std::uint8_t> is_placed(map_.points().slot_count(), 0);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    MapPoint* point = map_.find_point(points_[i]);
    // A point without a solution moves with its reference keyframe, like new points.
    if (point == nullptr || problem_.points[i] == before_[i]) continue;
    point->position = problem_.points[i];
    is_placed[points_[i].slot] = 1;
  }
  for (const MapPointId id : map_.points().ids()) {
    if (is_placed[id.slot] != 0) continue;
    motion.move_point(map_.point(id));
    ++summary_.points_carried;
  }
  map_.invalidate_copies();
}

/// Of the keyframes that have the poses of the solution.
void FullAdjustment::keep_motions(std::span<const Eigen::Isometry3d> poses) {
  for (const BundleFactors::Motion& motion : problem_.factors.motions) {
    KeyFrame* keyframe = map_.find_keyframe(keyframes_[motion.pose]);
    if (keyframe == nullptr || keyframe->frame.T_camera_world.matrix() != poses[motion.pose].matrix()) continue;
    const BundleFactors& factors = problem_.factors;
    const KeyFrameMotion found{motion.velocity / factors.scale, motion.bias};
    if (!found.is_possible()) continue;
    keyframe->motion = found;
    keyframe->vertical = (keyframe->frame.T_camera_world.linear() * factors.gravity).normalized();
  }
}

void FullAdjustment::remove_outliers() {
  in_portions(map_mutex_, problem_.observations.size(), [this](std::size_t i) {
    const BundleProblem::Observation& observation = problem_.observations[i];
    if (!observation.outlier) return;
    const MapPointId point = points_[observation.point];
    const KeyFrameId keyframe = keyframes_[observation.pose];
    if (map_.find_point(point) == nullptr || map_.find_keyframe(keyframe) == nullptr) return;
    map_.remove_observation(point, keyframe);
  });
}

}  // namespace holdfast
