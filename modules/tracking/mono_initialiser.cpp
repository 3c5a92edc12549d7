// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/mono_initialiser.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "holdfast/core/median.hpp"
#include "holdfast/geometry/two_view_certainty.hpp"
#include "holdfast/interfaces/frame_observations.hpp"
#include "holdfast/matching/rotation_consistency.hpp"
#include "holdfast/tracking/view_motion.hpp"

namespace holdfast {

namespace {

geometry::PixelPair pixel_pair(const Frame& a, std::uint32_t in_a, const Frame& b, std::uint32_t in_b) {
  const auto sigma2 = [](const Frame& frame, std::uint32_t feature) {
    return 1.0 / static_cast<double>(frame.pyramid->inverse_sigma2[frame.features.octave[feature]]);
  };
  return {{a.x[in_a], a.y[in_a]}, {b.x[in_b], b.y[in_b]}, sigma2(a, in_a), sigma2(b, in_b)};
}

}  // namespace

void MonoInitialiser::take_reference(const Frame& frame) {
  start_.reference = frame;
  start_.reference.T_camera_world.setIdentity();
  std::fill(start_.reference.map_points.begin(), start_.reference.map_points.end(), MapPointId());
  has_reference_ = true;
}

void MonoInitialiser::match(const Frame& frame, const std::vector<std::uint32_t>& features) {
  const Frame& reference = start_.reference;
  const std::vector<std::uint32_t> there = static_features(reference);
  const float strict = distance_limit(settings_.strict_distance, frame.features.descriptors.type().strict_distance);
  matcher_.match(side_of(reference, there), side_of(frame, features),
                 {.max_distance = strict, .ratio = static_cast<float>(settings_.descriptor_ratio), .mutual = true},
                 matches_);
  // While the map has not begun, the view changes by a part of the image only.
  constexpr float max_displacement = 0.3F;  // of the width
  const float reach = max_displacement * static_cast<float>(frame.camera->width);
  std::erase_if(matches_, [&](const FeatureMatch& match) {
    return std::hypot(reference.x[match.source] - frame.x[match.feature],
                      reference.y[match.source] - frame.y[match.feature]) > reach;
  });
  matching::keep_consistent_rotations(matches_, [&](const FeatureMatch& match) {
    return reference.features.angle[match.source] - frame.features.angle[match.feature];
  });
}

TrackingFailure MonoInitialiser::add(Frame& frame) {
  const std::vector<std::uint32_t> features = static_features(frame);
  if (static_cast<int>(features.size()) < settings_.minimum_start_points) {
    has_reference_ = false;
    return TrackingFailure::few_features;
  }
  if (!has_reference_) {
    take_reference(frame);
    return TrackingFailure::little_parallax;
  }
  match(frame, features);
  if (static_cast<int>(matches_.size()) < settings_.minimum_start_points) {
    take_reference(frame);
    return TrackingFailure::few_matches;
  }
  std::vector<geometry::PixelPair> pairs;
  std::vector<double> displacements;
  for (const FeatureMatch& match : matches_) {
    pairs.push_back(pixel_pair(start_.reference, match.source, frame, match.feature));
    displacements.push_back((pairs.back().a - pairs.back().b).norm());
  }
  constexpr double min_displacement = 0.01;  // of the width; a smaller one cannot be the parallax of many points
  if (upper_median(displacements) < min_displacement * frame.camera->width) return TrackingFailure::little_parallax;
  // Where more of the matches do not fit, people have been taken for the static world: another moment is better.
  constexpr double min_inliers = 0.8;
  const auto motion = geometry::find_two_view_motion(
      *frame.camera, pairs,
      {.minimum_points = settings_.minimum_start_points / 2, .minimum_inliers = min_inliers, .seed = random_.next()});
  if (!motion || !adjust(*motion, frame) || !is_certain(pairs, frame)) return TrackingFailure::little_parallax;
  has_reference_ = false;
  return TrackingFailure::none;
}

bool MonoInitialiser::is_certain(const std::vector<geometry::PixelPair>& pairs, const Frame& frame) const {
  if (settings_.start_deviation == 0.0) return true;
  std::vector<geometry::PixelPair> used;
  std::size_t match = 0;  // the points of the start are in the order of their matches
  for (const TwoViewMap::Point& point : start_.points) {
    while (matches_[match].source != point.in_reference || matches_[match].feature != point.in_frame) ++match;
    used.push_back(pairs[match]);
  }
  return geometry::direction_deviation(*frame.camera, used, frame.T_camera_world) <=
         settings_.start_deviation * std::numbers::pi / 180.0;
}

bool MonoInitialiser::adjust(const geometry::TwoViewMotion& motion, Frame& frame) {
  BundleProblem problem;
  problem.camera = frame.camera.get();
  problem.robust_iterations = problem.final_iterations = 20;
  problem.poses = {{Eigen::Isometry3d::Identity(), true}, {motion.T_b_a, false}};
  start_.points.clear();
  for (std::size_t i = 0; i < matches_.size(); ++i) {
    if (motion.good[i] == 0) continue;
    const auto point = static_cast<std::uint32_t>(problem.points.size());
    problem.points.push_back(motion.points[i]);
    problem.observations.push_back(bundle_observation(start_.reference, matches_[i].source, 0, point));
    problem.observations.push_back(bundle_observation(frame, matches_[i].feature, 1, point));
    start_.points.push_back({motion.points[i], matches_[i].source, matches_[i].feature});
  }
  const std::atomic<bool> stop{false};
  if (!optimizer_.optimize_bundle(problem, stop).usable) return false;

  std::vector<TwoViewMap::Point> kept;
  std::vector<double> depths;
  for (std::size_t i = 0; i < start_.points.size(); ++i) {
    const Eigen::Vector3d& position = problem.points[i];
    const double other_depth = (problem.poses[1].T_camera_world * position).z();
    if (problem.observations[2 * i].outlier || problem.observations[2 * i + 1].outlier || !(position.z() > 0.0) ||
        !(other_depth > 0.0))
      continue;
    kept.push_back({position, start_.points[i].in_reference, start_.points[i].in_frame});
    depths.push_back(position.z());
  }
  if (static_cast<int>(kept.size()) < settings_.minimum_start_points / 2) return false;
  const double unit = settings_.start_depth / upper_median(depths);
  for (TwoViewMap::Point& point : kept) point.position *= unit;
  frame.T_camera_world = problem.poses[1].T_camera_world;
  frame.T_camera_world.translation() *= unit;
  start_.points = std::move(kept);
  return true;
}

}  // namespace holdfast
