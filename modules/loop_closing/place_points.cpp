// SPDX-License-Identifier: BSD-3-Clause
#include "place_points.hpp"

#include <utility>

#include "holdfast/interfaces/frame_observations.hpp"
#include "holdfast/matching/frame_features.hpp"

namespace holdfast {

PlacePoints copy_points_seen_by(const Map& map, std::span<const KeyFrameId> keyframes) {
  PlacePoints points;
  for (const MapPointId id : points_seen_by(map, keyframes)) points.add(id, map.point(id));
  return points;
}

void copy_votes(const Map& map, PlacePoints& points) {
  points.votes.clear();
  for (const MapPointId id : points.block.ids) points.votes.push_back(map.class_votes(map.point(id)));
}

float match_distance(double configured, const DescriptorType& type) {
  return distance_limit(configured, type.distance_between(0.2F));
}

PointSearch find_points(const FeatureMatcher& matcher, const PointBlock& points, const Frame& frame,
                        const Eigen::Isometry3d& T_camera_world, double radius, double max_distance) {
  // The octave of points that were mapped from other viewpoints is less certain than in the local map.
  const matching::WindowSettings settings{
      .radius = static_cast<float>(radius), .frontal_radius = static_cast<float>(radius), .coarser_octaves = 1};
  PointSearch result;
  matching::SearchWindows windows;
  result.expected = matching::add_windows(
      frame, projection_into(frame, T_camera_world), points, settings, [](std::uint32_t) { return true; }, windows);
  matcher.match_guided(frame, {windows, points.descriptors},
                       {.max_distance = match_distance(max_distance, points.descriptors.type())}, {}, result.matches);
  result.visible = std::move(windows.source);
  return result;
}

PoseProblem pose_problem_of(const PlacePoints& points, const Frame& frame,
                            std::span<const matching::FeatureMatch> matches, const Eigen::Isometry3d& T_camera_world) {
  PoseProblem problem;
  problem.camera = frame.camera.get();
  problem.T_camera_world = T_camera_world;
  for (const matching::FeatureMatch& match : matches)
    add_observation(problem, frame, match.feature, points.positions[match.source]);
  return problem;
}

}  // namespace holdfast
