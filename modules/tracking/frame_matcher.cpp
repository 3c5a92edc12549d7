// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/frame_matcher.hpp"

#include <algorithm>
#include <optional>

namespace holdfast {

int FrameMatcher::match_previous(Frame& previous, float radius, Frame& frame) {
  return search_previous(previous, radius, frame, nullptr);
}

int FrameMatcher::match_previous_features(Frame& previous, float radius, Frame& frame,
                                          std::vector<OdometryMatch>& odometry) {
  odometry.clear();
  return search_previous(previous, radius, frame, &odometry);
}

int FrameMatcher::search_previous(Frame& previous, float radius, Frame& frame, std::vector<OdometryMatch>* odometry) {
  std::fill(frame.map_points.begin(), frame.map_points.end(), MapPointId());
  windows_.clear();
  const FrameProjection projection = projection_into(frame, frame.T_camera_world);
  const Eigen::Isometry3d T_previous_current = previous.T_camera_world * frame.T_camera_world.inverse();
  const double forward = T_previous_current.translation().z(), baseline = frame.camera->baseline;
  const int top_octave = frame.pyramid->levels() - 1;
  const Eigen::Isometry3d T_world_previous = previous.T_world_camera();
  for (std::size_t i = 0; i < previous.size(); ++i) {
    const MapPoint* point = nullptr;
    if (previous.map_points[i].valid()) {
      point = map_.find_point(previous.map_points[i]);
      if (point == nullptr) previous.map_points[i] = MapPointId();
    }
    if (point == nullptr && (odometry == nullptr || !previous.has_depth(i) || !is_static(previous, i))) continue;
    const Eigen::Vector3d position = point ? point->position : T_world_previous * previous.camera_point(i);
    const std::optional<matching::PredictedPixel> pixel = projection.project(position.cast<float>());
    if (!pixel) continue;
    const int octave = previous.features.octave[i];
    // When the camera moves forward, a feature can only be found at a coarser octave, and the other way round.
    int lowest = octave - 1, highest = octave + 1;
    if (forward > baseline) lowest = octave, highest = top_octave;
    if (forward < -baseline) lowest = 0, highest = octave;
    const float window = radius * frame.pyramid->scale[static_cast<std::size_t>(octave)];
    windows_.add(static_cast<std::uint32_t>(i), {*pixel, window, lowest, highest});
  }
  mark_unmatched(frame, usable_);
  const DescriptorType& type = frame.features.descriptors.type();
  matcher_.match_guided(frame, {windows_, previous.features.descriptors, previous.features.angle},
                        {.max_distance = distance_limit(settings_.loose_distance, type.loose_distance)}, usable_,
                        matches_);
  for (const FeatureMatch& match : matches_) {
    frame.map_points[match.feature] = previous.map_points[match.source];
    if (!previous.map_points[match.source].valid())
      odometry->push_back({match.feature, T_world_previous * previous.camera_point(match.source)});
  }
  return static_cast<int>(matches_.size());
}

int FrameMatcher::match_keyframe(const Frame& keyframe_frame, Frame& frame) {
  std::fill(frame.map_points.begin(), frame.map_points.end(), MapPointId());
  std::vector<std::uint32_t> known;
  for (std::size_t i = 0; i < keyframe_frame.size(); ++i)
    if (map_.find_point(keyframe_frame.map_points[i]) != nullptr) known.push_back(static_cast<std::uint32_t>(i));
  std::vector<std::uint32_t> all(frame.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint32_t>(i);

  // Mutual nearest neighbours with a clear lead over the second: no prediction narrows the search here.
  const float strict = distance_limit(settings_.strict_distance, frame.features.descriptors.type().strict_distance);
  matcher_.match(side_of(keyframe_frame, known), side_of(frame, all),
                 {.max_distance = strict, .ratio = static_cast<float>(settings_.descriptor_ratio), .mutual = true},
                 matches_);
  for (const FeatureMatch& match : matches_) frame.map_points[match.feature] = keyframe_frame.map_points[match.source];
  return static_cast<int>(matches_.size());
}

void FrameMatcher::match_local_map(float window, Frame& frame) {
  local_map_.update(map_, frame, map_.version());
  windows_.clear();
  local_map_.project(frame, window, windows_);
  mark_unmatched(frame, usable_);
  const float loose = distance_limit(settings_.loose_distance, frame.features.descriptors.type().loose_distance);
  const matching::GuidedSearchSettings settings{.max_distance = loose,
                                                .ratio = static_cast<float>(settings_.descriptor_ratio)};
  const PointBlock& points = local_map_.points();
  matcher_.match_guided(frame, {windows_, points.descriptors}, settings, usable_, matches_);
  for (const FeatureMatch& match : matches_) frame.map_points[match.feature] = points.ids[match.source];
}

}  // namespace holdfast
