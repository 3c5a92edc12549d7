// SPDX-License-Identifier: BSD-3-Clause
#include "place_points.hpp"

#include <limits>

#include "holdfast/core/hamming.hpp"

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

std::optional<ExpectedView> expected_view(const Frame& frame, const Eigen::Isometry3d& T_camera_world,
                                          const Eigen::Vector3d& position, const Eigen::Vector3d& direction,
                                          float minimum_distance, float maximum_distance) {
  constexpr double nearest = 0.05;      // m
  constexpr double least_cosine = 0.5;  // of the angle to the mean viewing direction
  const Eigen::Vector3d in_camera = T_camera_world * position;
  if (!(in_camera.z() > nearest)) return std::nullopt;
  ExpectedView view;
  view.pixel = frame.camera->project(in_camera);
  if (!frame.grid.covers(static_cast<float>(view.pixel.x()), static_cast<float>(view.pixel.y()))) return std::nullopt;
  const double distance = in_camera.norm();
  if (distance < 0.8 * minimum_distance || distance > 1.2 * maximum_distance) return std::nullopt;
  if (in_camera.dot(T_camera_world.linear() * direction) < least_cosine * distance) return std::nullopt;
  view.right_x = frame.camera->right_x(view.pixel.x(), in_camera.z());
  view.level = frame.pyramid->predict_level(maximum_distance, distance);
  return view;
}

PointSearch find_points(const PlacePoints& points, const Frame& frame, const Eigen::Isometry3d& T_camera_world,
                        double radius, int maximum_distance) {
  constexpr int unmatched = std::numeric_limits<int>::max();
  PointSearch search;
  std::vector<PointMatch> best_of_feature(frame.size(), PointMatch{0, 0, unmatched});
  std::vector<std::uint32_t> candidates;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const auto view = expected_view(frame, T_camera_world, points.positions[i], points.directions[i],
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
  for (const PointMatch& match : matches) {
    const std::uint32_t feature = match.feature;
    problem.points.push_back(points.positions[match.point]);
    problem.x.push_back(frame.x[feature]);
    problem.y.push_back(frame.y[feature]);
    problem.right_x.push_back(frame.right_x[feature]);
    problem.inverse_sigma2.push_back(frame.pyramid->inverse_sigma2[frame.features.octave[feature]]);
    problem.weight.push_back(frame.static_probability[feature]);
  }
  return problem;
}

}  // namespace holdfast
