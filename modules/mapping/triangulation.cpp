// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/geometry/triangulation.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>
#include <optional>

#include "holdfast/core/median.hpp"
#include "holdfast/geometry/epipolar.hpp"
#include "holdfast/matching/epipolar_search.hpp"
#include "holdfast/matching/frame_features.hpp"
#include "holdfast/matching/reprojection.hpp"
#include "mapping_steps.hpp"

namespace holdfast {

namespace {

/// A keyframe and a covisible neighbour.
struct TwoKeyframes {
  const Frame& frame;
  const Frame& neighbour;
  Eigen::Isometry3d T_frame_neighbour, T_neighbour_frame;
  double max_parallax_cosine;  // of triangulated points
};

/// A match between their features.
struct FeaturePair {
  std::uint32_t in_frame = 0, in_neighbour = 0;
};

/// Ray through a feature in the camera frame, z = 1.
Eigen::Vector3d ray_of(const Frame& frame, std::uint32_t feature) {
  return frame.camera->back_project(frame.x[feature], frame.y[feature], 1.0);
}

/// Cosine of the stereo parallax of a feature with depth: the angle subtended by the baseline at the point. Above 1
/// without depth, so that any parallax is larger.
double depth_cosine(const Frame& frame, std::uint32_t feature) {
  if (!frame.has_depth(feature)) return 2.0;
  return std::cos(2.0 * std::atan2(0.5 * frame.camera->baseline, static_cast<double>(frame.depth[feature])));
}

/// The point in the camera frame of the keyframe, by triangulation or by measured depth, whichever has more parallax.
std::optional<Eigen::Vector3d> locate(const TwoKeyframes& views, const FeaturePair& pair) {
  const Eigen::Vector3d ray = ray_of(views.frame, pair.in_frame);
  const Eigen::Vector3d other_ray = ray_of(views.neighbour, pair.in_neighbour);
  const double cosine = ray.normalized().dot((views.T_frame_neighbour.linear() * other_ray).normalized());
  const double frame_cosine = depth_cosine(views.frame, pair.in_frame);
  const double other_cosine = depth_cosine(views.neighbour, pair.in_neighbour);
  if (cosine > 0.0 && cosine < std::min({frame_cosine, other_cosine, views.max_parallax_cosine}))
    return geometry::triangulate_midpoint(Eigen::Vector3d::Zero(), ray, views.T_frame_neighbour.translation(),
                                          views.T_frame_neighbour.linear() * other_ray);
  if (views.frame.has_depth(pair.in_frame) && frame_cosine <= other_cosine)
    return views.frame.camera_point(pair.in_frame);
  if (views.neighbour.has_depth(pair.in_neighbour))
    return views.T_frame_neighbour * views.neighbour.camera_point(pair.in_neighbour);
  return std::nullopt;
}

/// Whether a point in the camera frame projects onto a feature.
bool projects_onto(const Frame& frame, std::uint32_t feature, const Eigen::Vector3d& in_camera) {
  constexpr double min_depth = 0.05;  // m
  if (in_camera.z() <= min_depth) return false;
  const Eigen::Vector2d pixel = frame.camera->project(in_camera);
  return matching::agrees_with_prediction(frame, feature, pixel.x(), pixel.y(),
                                          frame.camera->right_x(pixel.x(), in_camera.z()));
}

/// Scale consistency: whether the ratio of the octaves agrees with that of the distances to the point.
bool sizes_agree(const TwoKeyframes& views, const FeaturePair& pair, double distance_ratio) {
  const ScalePyramid &pyramid = *views.frame.pyramid, &other_pyramid = *views.neighbour.pyramid;
  const double octave_ratio =
      pyramid.scale[views.frame.features.octave[pair.in_frame]] /
      static_cast<double>(other_pyramid.scale[views.neighbour.features.octave[pair.in_neighbour]]);
  const double tolerance = 1.5 * pyramid.factor;
  return distance_ratio * tolerance >= octave_ratio && distance_ratio <= octave_ratio * tolerance;
}

/// The point of two matched features, in the camera frame of the keyframe; nothing if its reprojection does not fit
/// both.
std::optional<Eigen::Vector3d> triangulate(const TwoKeyframes& views, const FeaturePair& pair) {
  const std::optional<Eigen::Vector3d> in_frame = locate(views, pair);
  if (!in_frame) return std::nullopt;
  const Eigen::Vector3d in_neighbour = views.T_neighbour_frame * *in_frame;
  if (!projects_onto(views.frame, pair.in_frame, *in_frame) ||
      !projects_onto(views.neighbour, pair.in_neighbour, in_neighbour) ||
      !sizes_agree(views, pair, in_neighbour.norm() / in_frame->norm()))
    return std::nullopt;
  return in_frame;
}

/// Minimum baseline of two keyframes for sufficient parallax: that of the stereo pair, or, for one camera, a hundredth
/// of the median depth of the points that the neighbour observes (Mur-Artal et al. 2015, section VI-D).
double shortest_baseline(const Map& map, const Frame& neighbour) {
  if (features_have_depth(map.sensor())) return neighbour.camera->baseline;
  constexpr double share = 0.01;
  std::vector<double> depths;
  for (const MapPointId id : neighbour.map_points)
    if (const MapPoint* point = map.find_point(id)) depths.push_back((neighbour.T_camera_world * point->position).z());
  if (depths.empty()) return neighbour.camera->baseline;
  return share * upper_median(depths);
}

/// Static features without a map point.
std::vector<std::uint32_t> free_features(const Frame& frame) {
  std::vector<std::uint32_t> free;
  for (std::uint32_t i = 0; i < frame.size(); ++i)
    if (!frame.map_points[i].valid() && is_static(frame, i)) free.push_back(i);
  return free;
}

void triangulate_with(Map& map, KeyFrameId id, KeyFrameId neighbour_id, double max_parallax_cosine,
                      std::vector<MapPointId>& points) {
  const std::uint64_t sequence = map.keyframe(id).sequence;
  const Frame& frame = map.keyframe(id).frame;
  const Frame& neighbour = map.keyframe(neighbour_id).frame;
  const Eigen::Isometry3d T_frame_neighbour = frame.T_camera_world * neighbour.T_world_camera();
  const TwoKeyframes views{frame, neighbour, T_frame_neighbour, T_frame_neighbour.inverse(), max_parallax_cosine};
  if (T_frame_neighbour.translation().norm() < shortest_baseline(map, neighbour)) return;

  std::vector<std::uint32_t> candidates = free_features(neighbour);
  if (candidates.empty()) return;
  const Eigen::Matrix3d fundamental =
      geometry::fundamental_matrix(*frame.camera, frame.T_camera_world, neighbour.T_camera_world);
  matching::EpipolarSearch<Frame> search(frame, neighbour, fundamental,
                                         {.max_distance = frame.features.descriptors.type().strict_distance});
  const Eigen::Isometry3d T_world_frame = frame.T_world_camera();
  for (const std::uint32_t feature : free_features(frame)) {
    const std::optional<std::uint32_t> other = search.find(feature, candidates);
    if (!other) continue;
    const std::optional<Eigen::Vector3d> in_frame = triangulate(views, {feature, *other});
    if (!in_frame) continue;
    const MapPointId point = map.add_point(T_world_frame * *in_frame, sequence);
    map.add_observation(point, id, feature);
    map.add_observation(point, neighbour_id, *other);
    map.update_point(point);
    std::erase(candidates, *other);
    points.push_back(point);
  }
}

/// Sorts the neighbours by decreasing distance from the keyframe.
void sort_farthest_first(const Map& map, KeyFrameId id, std::vector<KeyFrameId>& neighbours) {
  const Eigen::Vector3d centre = map.keyframe(id).frame.T_world_camera().translation();
  const auto distance = [&](KeyFrameId neighbour) {
    return (map.keyframe(neighbour).frame.T_world_camera().translation() - centre).norm();
  };
  std::stable_sort(neighbours.begin(), neighbours.end(),
                   [&](KeyFrameId a, KeyFrameId b) { return distance(a) > distance(b); });
}

}  // namespace

std::vector<MapPointId> triangulate_points(Map& map, MapMutex& mutex, KeyFrameId id, const MappingSettings& settings) {
  constexpr double max_parallax_cosine = geometry::TriangulationOptions{}.max_parallax_cosine;
  std::vector<MapPointId> points;
  std::vector<KeyFrameId> neighbours;
  const auto triangulate_with_all = [&](double cosine) {
    for (const KeyFrameId neighbour : neighbours) {
      const std::lock_guard lock(mutex);
      triangulate_with(map, id, neighbour, cosine, points);
    }
  };
  {
    const std::lock_guard lock(mutex);
    neighbours = map.best_covisible(id, settings.neighbours);
  }
  triangulate_with_all(max_parallax_cosine);
  const double far_cosine = std::cos(settings.far_parallax * std::numbers::pi / 180.0);
  if (features_have_depth(map.sensor()) || far_cosine <= max_parallax_cosine) return points;
  {
    const std::lock_guard lock(mutex);
    sort_farthest_first(map, id, neighbours);
  }
  triangulate_with_all(far_cosine);
  return points;
}

}  // namespace holdfast
