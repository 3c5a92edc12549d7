// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "holdfast/geometry/se3.hpp"
#include "holdfast/interfaces/frame_observations.hpp"
#include "holdfast/mapping/local_mapper.hpp"
#include "holdfast/matching/point_block.hpp"

namespace holdfast {

void LocalMapper::adjust_bundle(KeyFrameId id) {
  {
    const std::lock_guard lock(mutex_);
    build_bundle_problem(id);
  }
  const BundleSummary summary = optimizer_.optimize_bundle(problem_, stop_);
  if (!summary.usable) return;
  const std::lock_guard lock(mutex_);
  apply_bundle();
}

void LocalMapper::build_bundle_problem(KeyFrameId id) {
  // Free are the keyframe, its strongest neighbours and all points that they observe; other keyframes that observe
  // these points are fixed.
  std::vector<KeyFrameId>& keyframes = problem_keyframes_;
  keyframes = {id};
  if (disparities_changed_) {
    // The disparities of all keyframes are corrected: the latest ones of this submap are free, covisible or not.
    constexpr std::size_t max_count = 40;
    const std::vector<KeyFrameId> by_age = map_.keyframes_by_age();
    for (auto other = by_age.rbegin(); other != by_age.rend() && keyframes.size() < max_count; ++other)
      if (*other != id && map_.keyframe(*other).submap == map_.keyframe(id).submap) keyframes.push_back(*other);
    disparities_changed_ = false;
  } else {
    for (const KeyFrameId neighbour : map_.best_covisible(id, settings_.bundle_keyframes - 1))
      keyframes.push_back(neighbour);
  }
  const std::size_t moving = keyframes.size();

  std::vector<std::int32_t> pose_of_slot(map_.keyframes().slot_count(), -1);
  for (std::size_t i = 0; i < moving; ++i) pose_of_slot[keyframes[i].slot] = static_cast<std::int32_t>(i);
  problem_points_ = points_seen_by(map_, keyframes);
  const std::vector<MapPointId>& points = problem_points_;

  problem_.camera = map_.keyframe(id).frame.camera.get();
  problem_.poses.clear();
  problem_.points.clear();
  problem_.observations.clear();
  problem_.robust_iterations = settings_.bundle_robust_iterations;
  problem_.final_iterations = settings_.bundle_final_iterations;
  problem_observations_.clear();
  problem_shared_points_.assign(moving, 0);
  for (std::uint32_t p = 0; p < points.size(); ++p) {
    const MapPoint& point = map_.point(points[p]);
    problem_.points.push_back(point.position);
    const bool is_shared = point.observations.size() > 1;
    for (const Observation& observation : point.observations) {
      std::int32_t& pose = pose_of_slot[observation.keyframe.slot];
      if (pose < 0) {
        pose = static_cast<std::int32_t>(keyframes.size());
        keyframes.push_back(observation.keyframe);
      }
      if (is_shared && static_cast<std::size_t>(pose) < moving)
        ++problem_shared_points_[static_cast<std::size_t>(pose)];
      problem_.observations.push_back(bundle_observation(map_.keyframe(observation.keyframe).frame, observation.feature,
                                                         static_cast<std::uint32_t>(pose), p));
      problem_observations_.emplace_back(points[p], observation.keyframe);
    }
  }
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    const KeyFrame& keyframe = map_.keyframe(keyframes[i]);
    problem_.poses.push_back({keyframe.frame.T_camera_world, i >= moving || keyframe.sequence == 0});
  }
  // Fix the gauge: if no keyframe is fixed, fix the oldest.
  if (std::none_of(problem_.poses.begin(), problem_.poses.end(), [](const auto& pose) { return pose.fixed; })) {
    std::size_t oldest = 0;
    for (std::size_t i = 1; i < keyframes.size(); ++i)
      if (map_.keyframe(keyframes[i]).sequence < map_.keyframe(keyframes[oldest]).sequence) oldest = i;
    problem_.poses[oldest].fixed = true;
  }
}

void LocalMapper::apply_bundle() {
  // Ids stay valid: the structure mutex is held, other threads may only add.
  for (std::size_t i = 0; i < problem_keyframes_.size(); ++i) {
    if (problem_.poses[i].fixed) continue;
    Eigen::Isometry3d& pose = map_.keyframe(problem_keyframes_[i]).frame.T_camera_world;
    const Eigen::Isometry3d change = problem_.poses[i].T_camera_world * pose.inverse();
    const bool has_diverged = problem_shared_points_[i] < minimum_shared_points &&
                              geometry::exceeds(change, local_divergence, local_divergence);
    if (!has_diverged) pose = problem_.poses[i].T_camera_world;
  }
  for (std::size_t p = 0; p < problem_points_.size(); ++p) map_.point(problem_points_[p]).position = problem_.points[p];
  for (std::size_t o = 0; o < problem_.observations.size(); ++o) {
    if (!problem_.observations[o].outlier) continue;
    const auto& [point, keyframe] = problem_observations_[o];
    if (map_.find_point(point) == nullptr) continue;
    map_.remove_observation(point, keyframe);
    drop_weak_point(point);
    ++counts_.observations_removed;
  }
  for (const MapPointId point : problem_points_)
    if (map_.find_point(point) != nullptr) map_.update_point_geometry(point);
  map_.invalidate_copies();
}

}  // namespace holdfast
