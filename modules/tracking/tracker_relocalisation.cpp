// SPDX-License-Identifier: BSD-3-Clause
// How a lost camera finds its place: among the last keyframes, then wherever the loop detector recognises something.
#include <algorithm>

#include "holdfast/geometry/pnp.hpp"
#include "holdfast/geometry/se3.hpp"
#include "holdfast/tracking/tracker.hpp"

namespace holdfast {

bool Tracker::coast(FrameResult& result) {
  // A short loss, such as when somebody walks past the lens, leaves the camera near where its velocity takes it.
  if (records_.empty() || current_.timestamp > coasts_until_) return false;
  const Record& last = records_.back();
  const Eigen::Isometry3d T_last_world = last.T_camera_reference * map_.pose_of(last.reference);
  const double steps = velocity_interval_ > 0.0 ? (current_.timestamp - last.timestamp) / velocity_interval_ : 0.0;
  for (const double share : {1.0, 0.5, 0.0}) {
    current_.T_camera_world = geometry::exp_se3(share * steps * geometry::log_se3(velocity_)) * T_last_world;
    std::fill(current_.map_points.begin(), current_.map_points.end(), MapPointId());
    match_local_map(static_cast<float>(3.0 * settings_.local_map_window));
    drop_outliers();
    const int inliers = match_local_map(static_cast<float>(settings_.local_map_window));
    drop_outliers();
    if (inliers < settings_.minimum_inliers) continue;
    result.method = TrackingMethod::recovered;
    return true;
  }
  result.trouble = TrackingTrouble::few_inliers;
  return false;
}

bool Tracker::recover(FrameResult& result) {
  constexpr int most_keyframes = 5;
  std::vector<KeyFrameId> candidates;
  if (map_.find_keyframe(last_keyframe_) != nullptr) candidates.push_back(last_keyframe_);
  for (const KeyFrameId id : {last_keyframe_, reference_keyframe_}) {
    if (map_.find_keyframe(id) == nullptr) continue;
    for (const KeyFrameId neighbour : map_.best_covisible(id, most_keyframes)) candidates.push_back(neighbour);
  }
  has_previous_ = has_velocity_ = false;
  std::vector<KeyFrameId> tried;
  for (const KeyFrameId candidate : candidates) {
    if (std::find(tried.begin(), tried.end(), candidate) != tried.end()) continue;
    if (static_cast<int>(tried.size()) >= most_keyframes) break;
    tried.push_back(candidate);
    if (!predict_with_keyframe(candidate, result) || !could_have_come_here()) continue;
    result.method = TrackingMethod::recovered;
    return true;
  }
  return false;
}

bool Tracker::relocalise(FrameResult& result) {
  // Mur-Artal et al. 2015, section V-C: candidates by appearance, a pose without a guess, then a guided search.
  has_previous_ = has_velocity_ = false;
  for (const PlaceMatch& place : detector_.query(current_.features.descriptors, settings_.relocalisation_candidates)) {
    const KeyFrame* keyframe = map_.find_keyframe(place.keyframe);
    if (keyframe == nullptr) continue;  // removed a moment ago, and the detector does not know yet
    match_descriptors(keyframe->frame);
    current_.T_camera_world = keyframe->frame.T_camera_world;
    state_problem();
    const geometry::PnpOptions options{.seed = random_.next()};
    if (!geometry::find_pose(problem_, options).usable) {
      result.trouble = TrackingTrouble::few_matches;
      continue;
    }
    current_.T_camera_world = problem_.T_camera_world;
    drop_outliers();
    if (!fits_surroundings(result) || !could_have_come_here()) continue;
    result.method = TrackingMethod::relocalised;
    return true;
  }
  return false;
}

bool Tracker::fits_surroundings(FrameResult& result) {
  // The first pose stands on few points and may be off by pixels: a wide window finds more, a narrow one the rest.
  int inliers = 0;
  for (const double window : {2.0 * settings_.local_map_window, settings_.local_map_window}) {
    inliers = match_local_map(static_cast<float>(window));
    drop_outliers();
  }
  if (inliers >= settings_.relocalisation_inliers) return true;
  result.trouble = TrackingTrouble::few_inliers;
  return false;
}

bool Tracker::could_have_come_here() const {
  if (records_.empty()) return true;  // it may have been carried into a map from anywhere
  const Record& last = records_.back();
  const Eigen::Isometry3d T_camera_world = last.T_camera_reference * map_.pose_of(last.reference);
  const double distance = (T_camera_world.inverse().translation() - current_.T_world_camera().translation()).norm();
  constexpr double tolerance = 1.0;  // [m], for poses that had gone astray before the loss
  return distance <= tolerance + settings_.relocalisation_speed * (current_.timestamp - last.timestamp);
}

}  // namespace holdfast
