// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/relocaliser.hpp"

#include <algorithm>
#include <vector>

#include "holdfast/geometry/alignment.hpp"
#include "holdfast/matching/frame_features.hpp"

namespace holdfast {

bool Relocaliser::relocalise(KeyFrameId last_keyframe, KeyFrameId reference, const cv::Mat& image, Frame& frame,
                             FrameResult& result) {
  if (coast(frame, result)) return true;
  parts_.history.interrupt();
  return recover(last_keyframe, reference, frame, result) || find_place(image, frame, result);
}

int Relocaliser::search_local_map(double window, Frame& frame) {
  parts_.matcher.match_local_map(static_cast<float>(window), frame);
  const int inliers = parts_.estimator.adjust(frame);
  parts_.estimator.drop_outliers(frame);
  return inliers;
}

bool Relocaliser::coast(Frame& frame, FrameResult& result) {
  // A short loss, such as when somebody walks past the lens, leaves the camera near where its velocity takes it.
  const FrameHistory& history = parts_.history;
  if (history.empty() || frame.timestamp > history.last_timestamp() + settings_.coasting_time) return false;
  const Eigen::Isometry3d T_last_world = history.last_pose(parts_.map);
  for (const double share : settings_.coasting_shares) {
    frame.T_camera_world = history.extrapolate(frame.timestamp, share) * T_last_world;
    std::fill(frame.map_points.begin(), frame.map_points.end(), MapPointId());
    search_local_map(settings_.coasting_window * settings_.local_map_window, frame);
    if (search_local_map(settings_.local_map_window, frame) < settings_.minimum_inliers) continue;
    result.method = TrackingMethod::recovered;
    return true;
  }
  result.failure = TrackingFailure::few_inliers;
  return false;
}

bool Relocaliser::recover(KeyFrameId last_keyframe, KeyFrameId reference, Frame& frame, FrameResult& result) {
  const int max_keyframes = settings_.recovery_keyframes;
  std::vector<KeyFrameId> candidates;
  if (parts_.map.find_keyframe(last_keyframe) != nullptr) candidates.push_back(last_keyframe);
  for (const KeyFrameId id : {last_keyframe, reference}) {
    if (parts_.map.find_keyframe(id) == nullptr) continue;
    for (const KeyFrameId neighbour : parts_.map.best_covisible(id, max_keyframes)) candidates.push_back(neighbour);
  }
  std::vector<KeyFrameId> tried;
  for (const KeyFrameId candidate : candidates) {
    if (std::find(tried.begin(), tried.end(), candidate) != tried.end()) continue;
    if (static_cast<int>(tried.size()) >= max_keyframes) break;
    tried.push_back(candidate);
    if (!align_with_keyframe(candidate, std::nullopt, frame, result) ||
        !is_reachable(frame, settings_.relocalisation_tolerance))
      continue;
    // The depth of the features contradicts a wrong pose; with one camera, only points around it can.
    if (!features_have_depth(parts_.map.sensor()) && !fits_surroundings(frame, result)) continue;
    result.method = TrackingMethod::recovered;
    return true;
  }
  return false;
}

bool Relocaliser::align_with_keyframe(KeyFrameId keyframe, const std::optional<Eigen::Isometry3d>& start, Frame& frame,
                                      FrameResult& result) {
  const KeyFrame* found = parts_.map.find_keyframe(keyframe);
  if (found == nullptr) return false;
  if (parts_.matcher.match_keyframe(found->frame, frame) < settings_.minimum_matches / 2) {
    result.failure = TrackingFailure::few_matches;
    return false;
  }
  // Matches without prediction contain enough outliers to mislead an adjustment that starts far away: a rigid alignment
  // of the features' depth with the map (three points, random samples) finds the start.
  std::vector<Eigen::Vector3d> in_world, in_camera;
  for (std::size_t i = 0; i < frame.size(); ++i)
    if (frame.map_points[i].valid() && frame.has_depth(i)) {
      in_world.push_back(parts_.map.point(frame.map_points[i]).position);
      in_camera.push_back(frame.camera_point(i));
    }
  frame.T_camera_world = start.value_or(found->frame.T_camera_world);
  if (!features_have_depth(parts_.map.sensor())) {
    // One camera has no depth: three points and their directions give a pose as well.
    parts_.estimator.build_problem(frame);
    if (geometry::find_pose(parts_.estimator.problem(), geometry::PnpOptions{.seed = random_.next()}).usable)
      frame.T_camera_world = parts_.estimator.problem().T_camera_world;
  }
  const geometry::AlignmentRansacOptions options{.threshold = settings_.alignment_threshold, .seed = random_.next()};
  if (const auto aligned = geometry::align_points_ransac(in_world, in_camera, options))
    frame.T_camera_world = aligned->similarity.motion();
  const int inliers = parts_.estimator.adjust(frame);
  parts_.estimator.drop_outliers(frame);
  if (inliers < settings_.minimum_matches / 2) {
    result.failure = TrackingFailure::few_inliers;
    return false;
  }
  result.method = TrackingMethod::reference_keyframe;
  return true;
}

bool Relocaliser::find_place(const cv::Mat& image, Frame& frame, FrameResult& result) {
  // The database contains static features only, and so does the query. Points that an earlier hypothesis matched say
  // nothing about this place: the weights come from the frame alone.
  std::fill(frame.map_points.begin(), frame.map_points.end(), MapPointId());
  parts_.estimator.build_problem(frame);
  const bool of_image = parts_.detector.image_descriptor().has_value();
  if (of_image)
    frame.image_descriptor =
        parts_.detector.describe(image, parts_.moving_world.moving_pixels(frame.coarse, weights_.minor_labels()));
  for (const PlaceMatch& place : similar_places(frame, of_image)) {
    const KeyFrame* keyframe = parts_.map.find_keyframe(place.keyframe);
    if (keyframe == nullptr) continue;  // removed a moment ago, and the detector does not know yet
    parts_.matcher.match_keyframe(keyframe->frame, frame);
    frame.T_camera_world = keyframe->frame.T_camera_world;
    parts_.estimator.build_problem(frame);
    const geometry::PnpOptions options{.seed = random_.next()};
    if (!geometry::find_pose(parts_.estimator.problem(), options).usable) {
      result.failure = TrackingFailure::few_matches;
      continue;
    }
    frame.T_camera_world = parts_.estimator.problem().T_camera_world;
    parts_.estimator.drop_outliers(frame);
    if (!fits_surroundings(frame, result) || !is_reachable(frame, settings_.relocalisation_tolerance)) continue;
    result.method = TrackingMethod::relocalised;
    return true;
  }
  return false;
}

std::vector<PlaceMatch> Relocaliser::similar_places(const Frame& frame, bool of_image) const {
  const int count = settings_.relocalisation_candidates;
  const DescriptorBlock descriptors = place_descriptors(frame, of_image);
  if (of_image || weights_.are_uniform()) return parts_.detector.query(descriptors, count);
  return parts_.detector.query_weighted(descriptors, weights_.of_static_features(frame), count);
}

bool Relocaliser::fits_surroundings(Frame& frame, FrameResult& result) {
  // The first pose depends on few points and may be off by pixels: a wide window finds more, a narrow one the rest.
  search_local_map(settings_.relocalisation_window * settings_.local_map_window, frame);
  const int inliers = search_local_map(settings_.local_map_window, frame);
  if (inliers >= settings_.relocalisation_inliers && is_beyond_chance(inliers)) return true;
  result.failure = TrackingFailure::few_inliers;
  return false;
}

bool Relocaliser::is_beyond_chance(int inliers) const {
  return features_have_depth(parts_.map.sensor()) ||
         inliers >= settings_.relocalisation_chance * parts_.estimator.matches();
}

bool Relocaliser::is_reachable(const Frame& frame, double tolerance) const {
  const FrameHistory& history = parts_.history;
  if (history.empty()) return true;  // a camera may start anywhere in a loaded map
  const Eigen::Isometry3d T_camera_world = history.last_pose(parts_.map);
  const double distance = (T_camera_world.inverse().translation() - frame.T_world_camera().translation()).norm();
  return distance <= tolerance + settings_.relocalisation_speed * (frame.timestamp - history.last_timestamp());
}

}  // namespace holdfast
