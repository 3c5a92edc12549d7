// SPDX-License-Identifier: BSD-3-Clause
// How a frame gets its first pose: by velocity, or from the reference keyframe.
#include <algorithm>
#include <cmath>

#include "holdfast/core/hamming.hpp"
#include "holdfast/geometry/alignment.hpp"
#include "holdfast/geometry/pose_observation.hpp"
#include "holdfast/geometry/se3.hpp"
#include "holdfast/tracking/tracker.hpp"

namespace holdfast {

void Tracker::state_problem() {
  filters_.weigh(map_, current_);
  problem_.clear();
  problem_features_.clear();
  problem_.camera = current_.camera.get();
  problem_.T_camera_world = current_.T_camera_world;
  for (std::size_t i = 0; i < current_.size(); ++i) {
    if (!current_.map_points[i].valid()) continue;
    const MapPoint* point = map_.find_point(current_.map_points[i]);
    if (point == nullptr) {
      current_.map_points[i] = MapPointId();
      continue;
    }
    geometry::add_observation(problem_, current_, i, point->position);
    problem_features_.push_back(static_cast<std::uint32_t>(i));
  }
  problem_.inlier.assign(problem_.size(), 0);
}

int Tracker::adjust_pose() {
  state_problem();
  const PoseSummary summary = optimizer_.optimize_pose(problem_);
  pose_deviation_ = summary.usable ? std::sqrt(summary.covariance.topLeftCorner<3, 3>().trace()) : 0.0;
  if (!summary.usable) {
    std::fill(problem_.inlier.begin(), problem_.inlier.end(), std::uint8_t{0});
    return 0;
  }
  current_.T_camera_world = problem_.T_camera_world;
  if (filters_.empty()) return summary.inliers;
  // What does not stand still may agree by chance, and is no reason to believe a pose.
  int inliers = 0;
  for (std::size_t i = 0; i < problem_.size(); ++i)
    inliers += problem_.inlier[i] != 0 && problem_.weight[i] >= 0.5F ? 1 : 0;
  return inliers;
}

void Tracker::drop_outliers() {
  for (std::size_t i = 0; i < problem_features_.size(); ++i)
    if (problem_.inlier[i] == 0) current_.map_points[problem_features_[i]] = MapPointId();
}

int Tracker::match_previous(float radius_factor) {
  windows_.clear();
  const Camera& camera = *current_.camera;
  const Eigen::Isometry3d T_previous_current = previous_.T_camera_world * current_.T_camera_world.inverse();
  const double forward = T_previous_current.translation().z();
  const double baseline = camera.baseline;
  const int top_level = current_.pyramid->levels() - 1;
  for (std::size_t i = 0; i < previous_.size(); ++i) {
    if (!previous_.map_points[i].valid()) continue;
    const MapPoint* point = map_.find_point(previous_.map_points[i]);
    if (point == nullptr) {
      previous_.map_points[i] = MapPointId();
      continue;
    }
    const Eigen::Vector3d in_camera = current_.T_camera_world * point->position;
    if (in_camera.z() <= 0.05) continue;
    const Eigen::Vector2d pixel = camera.project(in_camera);
    if (!current_.grid.covers(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()))) continue;
    const int octave = previous_.features.octave[i];
    // Coming nearer, a feature can only be found at a coarser level, and the other way round.
    int lowest = octave - 1, highest = octave + 1;
    if (forward > baseline) lowest = octave, highest = top_level;
    if (forward < -baseline) lowest = 0, highest = octave;
    windows_.add(static_cast<std::uint32_t>(i), static_cast<float>(pixel.x()), static_cast<float>(pixel.y()),
                 static_cast<float>(camera.right_x(pixel.x(), in_camera.z())),
                 radius_factor * current_.pyramid->scale[static_cast<std::size_t>(octave)], lowest, highest);
  }
  MatchRule rule;
  rule.maximum_distance = settings_.possible_distance;
  rule.angles = previous_.features.angle.data();
  const auto& matches = search_.match(windows_, previous_.features.descriptors.data(), current_, rule);
  for (const ProjectionMatch& match : matches) current_.map_points[match.feature] = previous_.map_points[match.source];
  return static_cast<int>(matches.size());
}

Eigen::Isometry3d Tracker::predicted_step() const {
  if (!has_velocity_ || velocity_interval_ <= 0.0) return Eigen::Isometry3d::Identity();
  // Recordings leave frames out: the same speed over the time that really passed.
  const double ratio = std::clamp((current_.timestamp - previous_.timestamp) / velocity_interval_, 0.0, 4.0);
  return std::abs(ratio - 1.0) < 0.05 ? velocity_ : geometry::exp_se3(ratio * geometry::log_se3(velocity_));
}

bool Tracker::predict_with_velocity(FrameResult& result) {
  if (!has_previous_) return false;
  const Eigen::Isometry3d step = predicted_step();
  const float window = static_cast<float>(settings_.motion_window);
  for (const float radius : {window, 2.0F * window}) {
    current_.T_camera_world = step * previous_.T_camera_world;
    std::fill(current_.map_points.begin(), current_.map_points.end(), MapPointId());
    if (match_previous(radius) < settings_.minimum_matches) continue;
    const int inliers = adjust_pose();
    drop_outliers();
    if (inliers >= settings_.minimum_matches / 2) {
      result.method = TrackingMethod::motion_model;
      return true;
    }
  }
  result.trouble = TrackingTrouble::few_matches;
  return false;
}

void Tracker::match_descriptors(const Frame& keyframe_frame) {
  std::fill(current_.map_points.begin(), current_.map_points.end(), MapPointId());
  std::vector<std::uint32_t> known;
  for (std::size_t i = 0; i < keyframe_frame.size(); ++i)
    if (map_.find_point(keyframe_frame.map_points[i]) != nullptr) known.push_back(static_cast<std::uint32_t>(i));
  std::vector<std::uint32_t> all(current_.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint32_t>(i);

  // Mutual nearest neighbours with a clear lead over the second: no prediction narrows the search here.
  const Descriptor* ours = current_.features.descriptors.data();
  const Descriptor* theirs = keyframe_frame.features.descriptors.data();
  for (const std::uint32_t k : known) {
    const NearestDescriptors nearest = nearest_descriptors(theirs[k], ours, all);
    if (nearest.best_index < 0 || nearest.best_distance > settings_.sure_distance) continue;
    if (nearest.second_index >= 0 &&
        static_cast<float>(nearest.best_distance) > 0.8F * static_cast<float>(nearest.second_distance))
      continue;
    const auto feature = static_cast<std::size_t>(nearest.best_index);
    if (nearest_descriptors(ours[feature], theirs, known).best_index != static_cast<int>(k)) continue;
    current_.map_points[feature] = keyframe_frame.map_points[k];
  }
}

bool Tracker::predict_with_keyframe(KeyFrameId keyframe, FrameResult& result) {
  const KeyFrame* found = map_.find_keyframe(keyframe);
  if (found == nullptr) return false;
  match_descriptors(found->frame);
  const auto matches =
      std::count_if(current_.map_points.begin(), current_.map_points.end(), [](MapPointId id) { return id.valid(); });
  if (matches < settings_.minimum_matches / 2) {
    result.trouble = TrackingTrouble::few_matches;
    return false;
  }
  // Matches without prediction hold outliers enough to mislead a descent from a far start: a rigid alignment of the
  // features' depth with the map finds the start (three points, random samples, the run's seed).
  std::vector<Eigen::Vector3d> in_world, in_camera;
  for (std::size_t i = 0; i < current_.size(); ++i)
    if (current_.map_points[i].valid() && current_.has_depth(i)) {
      in_world.push_back(map_.point(current_.map_points[i]).position);
      in_camera.push_back(current_.camera_point(i));
    }
  current_.T_camera_world = has_previous_ ? previous_.T_camera_world : found->frame.T_camera_world;
  const geometry::AlignmentRansacOptions options{.threshold = 0.06, .seed = random_.next()};
  if (const auto aligned = geometry::align_points_ransac(in_world, in_camera, options))
    current_.T_camera_world = aligned->similarity.motion();
  const int inliers = adjust_pose();
  drop_outliers();
  if (inliers < settings_.minimum_matches / 2) {
    result.trouble = TrackingTrouble::few_inliers;
    return false;
  }
  result.method = TrackingMethod::reference_keyframe;
  return true;
}

}  // namespace holdfast
