// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <optional>

#include "holdfast/core/hamming.hpp"
#include "holdfast/geometry/triangulation.hpp"
#include "holdfast/mapping/local_mapper.hpp"
#include "reprojection.hpp"
#include "static_features.hpp"

namespace holdfast {

namespace {

constexpr int maximum_distance = 50;  // bits
constexpr double smallest_parallax_cosine = 0.9998;

/// Ray through a feature in the camera frame, z = 1.
Eigen::Vector3d ray_of(const Frame& frame, std::uint32_t feature) {
  return frame.camera->back_project(frame.x[feature], frame.y[feature], 1.0);
}

/// Whether a point in the camera frame projects onto a feature.
bool agrees(const Frame& frame, std::uint32_t feature, const Eigen::Vector3d& in_camera) {
  constexpr double nearest = 0.05;  // m
  if (in_camera.z() <= nearest) return false;
  const Eigen::Vector2d pixel = frame.camera->project(in_camera);
  return reprojects_onto(frame, feature, pixel, frame.camera->right_x(pixel.x(), in_camera.z()));
}

std::vector<std::uint32_t> free_features(const Frame& frame) {
  std::vector<std::uint32_t> free;
  for (std::uint32_t i = 0; i < frame.size(); ++i)
    if (!frame.map_points[i].valid() && is_static(frame, i)) free.push_back(i);
  return free;
}

}  // namespace

void LocalMapper::triangulate_points(KeyFrameId id) {
  std::vector<KeyFrameId> neighbours;
  {
    const std::lock_guard lock(mutex_);
    neighbours = map_.best_covisible(id, settings_.neighbours);
  }
  for (const KeyFrameId neighbour : neighbours) {
    const std::lock_guard lock(mutex_);
    triangulate_with(id, neighbour);
  }
}

void LocalMapper::triangulate_with(KeyFrameId id, KeyFrameId neighbour_id) {
  const std::uint64_t sequence = map_.keyframe(id).sequence;
  const Frame& frame = map_.keyframe(id).frame;
  const Frame& neighbour = map_.keyframe(neighbour_id).frame;
  const Eigen::Isometry3d T_frame_neighbour = frame.T_camera_world * neighbour.T_world_camera();
  const Eigen::Isometry3d T_neighbour_frame = T_frame_neighbour.inverse();
  if (T_frame_neighbour.translation().norm() < frame.camera->baseline) return;

  const std::vector<std::uint32_t> free = free_features(frame), free_in_neighbour = free_features(neighbour);
  if (free_in_neighbour.empty()) return;
  const Eigen::Isometry3d T_world_frame = frame.T_world_camera();
  std::vector<std::uint32_t> candidates;
  for (const std::uint32_t feature : free) {
    // Candidates lie near the epipolar line of the feature in the neighbour, after its epipole and before infinity.
    const Eigen::Vector3d ray = ray_of(frame, feature);
    const Eigen::Vector3d line = T_neighbour_frame.translation().cross(T_neighbour_frame.linear() * ray);
    const double a = line.x() / neighbour.camera->fx, b = line.y() / neighbour.camera->fy;
    const double c = line.z() - a * neighbour.camera->cx - b * neighbour.camera->cy;
    const double inverse_norm2 = 1.0 / (a * a + b * b);
    candidates.clear();
    for (const std::uint32_t other : free_in_neighbour) {
      if (neighbour.map_points[other].valid()) continue;
      const double offset = a * neighbour.x[other] + b * neighbour.y[other] + c;
      constexpr double limit = 3.84;  // chi-square 95 %, one residual
      if (offset * offset * inverse_norm2 < limit * neighbour.pyramid->sigma2[neighbour.features.octave[other]])
        candidates.push_back(other);
    }
    const NearestDescriptors nearest =
        nearest_descriptors(frame.features.descriptors[feature], neighbour.features.descriptors.data(), candidates);
    if (nearest.best_index < 0 || nearest.best_distance > maximum_distance) continue;
    const auto other = static_cast<std::uint32_t>(nearest.best_index);
    if (nearest.second_index >= 0 && nearest.best_distance > 0.8 * nearest.second_distance) continue;

    // The better of parallax and measured depth decides where the point is.
    const Eigen::Vector3d other_ray = ray_of(neighbour, other);
    const double cosine = ray.normalized().dot((T_frame_neighbour.linear() * other_ray).normalized());
    std::optional<Eigen::Vector3d> in_frame;
    const auto depth_cosine = [](const Frame& f, std::uint32_t i) {
      return f.has_depth(i) ? std::cos(2.0 * std::atan2(0.5 * f.camera->baseline, static_cast<double>(f.depth[i])))
                            : 2.0;
    };
    const double frame_cosine = depth_cosine(frame, feature), other_cosine = depth_cosine(neighbour, other);
    if (cosine > 0.0 && cosine < std::min({frame_cosine, other_cosine, smallest_parallax_cosine}))
      in_frame = geometry::triangulate_midpoint(Eigen::Vector3d::Zero(), ray, T_frame_neighbour.translation(),
                                                T_frame_neighbour.linear() * other_ray);
    else if (frame.has_depth(feature) && frame_cosine <= other_cosine)
      in_frame = frame.camera_point(feature);
    else if (neighbour.has_depth(other))
      in_frame = T_frame_neighbour * neighbour.camera_point(other);
    if (!in_frame) continue;
    const Eigen::Vector3d in_neighbour = T_neighbour_frame * *in_frame;
    if (!agrees(frame, feature, *in_frame) || !agrees(neighbour, other, in_neighbour)) continue;

    // The sizes of the feature in both images must fit the distances.
    const double distance_ratio = in_neighbour.norm() / in_frame->norm();
    const double octave_ratio = frame.pyramid->scale[frame.features.octave[feature]] /
                                static_cast<double>(neighbour.pyramid->scale[neighbour.features.octave[other]]);
    const double tolerance = 1.5 * frame.pyramid->factor;
    if (distance_ratio * tolerance < octave_ratio || distance_ratio > octave_ratio * tolerance) continue;

    const MapPointId point = map_.add_point(T_world_frame * *in_frame, sequence);
    map_.add_observation(point, id, feature);
    map_.add_observation(point, neighbour_id, other);
    map_.update_point(point);
    recent_points_.push_back(point);
    ++counts_.points_triangulated;
  }
}

}  // namespace holdfast
