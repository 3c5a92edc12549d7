// SPDX-License-Identifier: BSD-3-Clause
#include "place_points.hpp"

#include <limits>

#include "holdfast/core/hamming.hpp"
#include "holdfast/geometry/expected_view.hpp"
#include "holdfast/geometry/pose_observation.hpp"

namespace holdfast {

void PlacePoints::add(MapPointId id, const MapPoint& point) {
  ids.push_back(id);
  positions.push_back(point.position);
  directions.push_back(point.viewing_direction);
  minimum_distance.push_back(point.minimum_distance);
  maximum_distance.push_back(point.maximum_distance);
  descriptors.push_back(point.descriptor);
}

PlacePoints points_seen_by(const Map& map, std::span<const KeyFrameId> keyframes) {
  PlacePoints points;
  std::vector<std::uint8_t> taken(map.points().slot_count(), 0);
  for (const KeyFrameId keyframe : keyframes)
    for (const MapPointId id : map.keyframe(keyframe).frame.map_points) {
      if (!id.valid() || taken[id.slot] != 0) continue;
      taken[id.slot] = 1;
      points.add(id, map.point(id));
    }
  return points;
}

PointSearch find_points(const PlacePoints& points, const Frame& frame, const Eigen::Isometry3d& T_camera_world,
                        double radius, int maximum_distance) {
  constexpr int unmatched = std::numeric_limits<int>::max();
  PointSearch search;
  std::vector<PointMatch> best_of_feature(frame.size(), PointMatch{0, 0, unmatched});
  std::vector<std::uint32_t> candidates;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const auto view = geometry::expected_view(frame, T_camera_world, points.positions[i], points.directions[i],
                                              points.minimum_distance[i], points.maximum_distance[i]);
    if (!view) continue;
    ++search.expected;
    const float window = static_cast<float>(radius) * frame.pyramid->scale[static_cast<std::size_t>(view->level)];
    candidates.clear();
    frame.grid.query(static_cast<float>(view->pixel.x()), static_cast<float>(view->pixel.y()), window, frame.x, frame.y,
                     candidates);
    std::erase_if(candidates, [&](std::uint32_t feature) {
      const int octave = frame.features.octave[feature];
      if (octave < view->level - 1 || octave > view->level + 1) return true;
      return std::abs(frame.right_x[feature] - view->right_x) > window;  // false without depth
    });
    const NearestDescriptors nearest =
        nearest_descriptors(points.descriptors[i], frame.features.descriptors.data(), candidates);
    if (nearest.best_index < 0 || nearest.best_distance > maximum_distance) continue;
    PointMatch& best = best_of_feature[static_cast<std::size_t>(nearest.best_index)];
    if (nearest.best_distance < best.distance)
      best = {i, static_cast<std::uint32_t>(nearest.best_index), nearest.best_distance};
  }
  for (const PointMatch& match : best_of_feature)
    if (match.distance != unmatched) search.matches.push_back(match);
  return search;
}

PoseProblem pose_problem_of(const PlacePoints& points, const Frame& frame, std::span<const PointMatch> matches,
                            const Eigen::Isometry3d& T_camera_world) {
  PoseProblem problem;
  problem.camera = frame.camera.get();
  problem.T_camera_world = T_camera_world;
  for (const PointMatch& match : matches)
    geometry::add_observation(problem, frame, match.feature, points.positions[match.point]);
  return problem;
}

}  // namespace holdfast
