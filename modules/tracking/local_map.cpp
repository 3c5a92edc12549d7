// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/local_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace holdfast {

void LocalMap::update(Map& map, const Frame& frame, std::uint64_t map_version) {
  const KeyFrameId previous_reference = reference_keyframe_;
  const bool voted = vote(map, frame);
  if (!voted && !reference_keyframe_.valid()) return;
  if (map_version == map_version_ && reference_keyframe_ == previous_reference) return;
  write_counts(map);
  map_version_ = map_version;
  if (voted) collect_keyframes(map);
  collect_points(map);
}

bool LocalMap::vote(const Map& map, const Frame& frame) {
  votes_.resize(map.keyframes().slot_count(), 0);
  voted_.clear();
  for (const MapPointId id : frame.map_points) {
    if (!id.valid()) continue;
    const MapPoint* point = map.find_point(id);
    if (point == nullptr) continue;
    for (const Observation& observation : point->observations)
      if (votes_[observation.keyframe.slot]++ == 0) voted_.push_back(observation.keyframe);
  }
  if (voted_.empty()) return false;
  // Most votes first; of equal ones the later slot, which tends to be the later keyframe.
  std::sort(voted_.begin(), voted_.end(), [&](KeyFrameId a, KeyFrameId b) {
    return votes_[a.slot] != votes_[b.slot] ? votes_[a.slot] > votes_[b.slot] : a.slot > b.slot;
  });
  reference_keyframe_ = voted_.front();
  for (const KeyFrameId id : voted_) votes_[id.slot] = 0;
  return true;
}

void LocalMap::collect_keyframes(const Map& map) {
  keyframes_.clear();
  std::vector<std::uint8_t> taken(map.keyframes().slot_count(), 0);
  const auto take = [&](KeyFrameId id) {
    if (!id.valid() || taken[id.slot] != 0 || static_cast<int>(keyframes_.size()) >= most_keyframes_) return false;
    taken[id.slot] = 1;
    keyframes_.push_back(id);
    return true;
  };
  for (const KeyFrameId id : voted_) take(id);
  const std::size_t sharing = keyframes_.size();
  constexpr int neighbours = 10;
  for (std::size_t i = 0; i < sharing; ++i) {
    const KeyFrame& keyframe = map.keyframe(keyframes_[i]);
    for (const KeyFrameId neighbour : map.best_covisible(keyframes_[i], neighbours))
      if (take(neighbour)) break;
    for (const KeyFrameId child : keyframe.children)
      if (take(child)) break;
    take(keyframe.parent);
  }
}

void LocalMap::collect_points(const Map& map) {
  points_.clear();
  index_of_slot_.assign(map.points().slot_count(), -1);
  std::erase_if(keyframes_, [&](KeyFrameId id) { return map.find_keyframe(id) == nullptr; });
  for (const KeyFrameId id : keyframes_)
    for (const MapPointId point : map.keyframe(id).frame.map_points) {
      if (!point.valid() || index_of_slot_[point.slot] >= 0) continue;
      index_of_slot_[point.slot] = static_cast<std::int32_t>(points_.size());
      points_.push_back(point);
    }
  const std::size_t count = points_.size();
  for (std::vector<float>* values : {&position_x_, &position_y_, &position_z_, &direction_x_, &direction_y_,
                                     &direction_z_, &minimum_distance_, &maximum_distance_})
    values->resize(count);
  descriptors_.resize(count);
  visible_.assign(count, 0);
  found_.assign(count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    const MapPoint& point = map.point(points_[i]);
    position_x_[i] = static_cast<float>(point.position.x());
    position_y_[i] = static_cast<float>(point.position.y());
    position_z_[i] = static_cast<float>(point.position.z());
    direction_x_[i] = static_cast<float>(point.viewing_direction.x());
    direction_y_[i] = static_cast<float>(point.viewing_direction.y());
    direction_z_[i] = static_cast<float>(point.viewing_direction.z());
    minimum_distance_[i] = point.minimum_distance;
    maximum_distance_[i] = point.maximum_distance;
    descriptors_[i] = point.descriptor;
  }
}

void LocalMap::mark_shown(const Frame& frame) {
  shown_.assign(points_.size(), 0);
  for (const MapPointId id : frame.map_points) {
    if (!id.valid() || id.slot >= index_of_slot_.size()) continue;
    const std::int32_t index = index_of_slot_[id.slot];
    if (index >= 0 && points_[static_cast<std::size_t>(index)] == id) shown_[static_cast<std::size_t>(index)] = 1;
  }
}

void LocalMap::project(const Frame& frame, float radius_factor, SearchWindows& windows) {
  mark_shown(frame);
  const Camera& camera = *frame.camera;
  const ScalePyramid& pyramid = *frame.pyramid;
  const Eigen::Matrix3f R = frame.T_camera_world.linear().cast<float>();
  const Eigen::Vector3f t = frame.T_camera_world.translation().cast<float>();
  const Eigen::Vector3f centre = -(R.transpose() * t);
  const float fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
  const float cx = static_cast<float>(camera.cx), cy = static_cast<float>(camera.cy);
  const float fx_baseline = static_cast<float>(camera.fx * camera.baseline);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const float px = position_x_[i], py = position_y_[i], pz = position_z_[i];
    const float z = R(2, 0) * px + R(2, 1) * py + R(2, 2) * pz + t.z();
    if (z <= 0.05F) continue;
    const float inverse_z = 1.0F / z;
    const float x = fx * (R(0, 0) * px + R(0, 1) * py + R(0, 2) * pz + t.x()) * inverse_z + cx;
    const float y = fy * (R(1, 0) * px + R(1, 1) * py + R(1, 2) * pz + t.y()) * inverse_z + cy;
    if (!frame.grid.covers(x, y)) continue;
    const float dx = px - centre.x(), dy = py - centre.y(), dz = pz - centre.z();
    const float distance = std::sqrt(dx * dx + dy * dy + dz * dz);
    if (distance < 0.8F * minimum_distance_[i] || distance > 1.2F * maximum_distance_[i]) continue;
    const float cosine = (dx * direction_x_[i] + dy * direction_y_[i] + dz * direction_z_[i]) / distance;
    if (cosine < 0.5F) continue;  // 60 degrees away from where it was seen
    ++visible_[i];
    if (shown_[i] != 0) continue;
    const int level = pyramid.predict_level(maximum_distance_[i], distance);
    const float radius =
        (cosine > 0.998F ? 2.5F : 4.0F) * radius_factor * pyramid.scale[static_cast<std::size_t>(level)];
    windows.add(static_cast<std::uint32_t>(i), x, y, x - fx_baseline * inverse_z, radius, level - 1, level);
  }
}

void LocalMap::count_found(const Frame& frame) {
  mark_shown(frame);
  for (std::size_t i = 0; i < points_.size(); ++i) found_[i] += shown_[i];
}

void LocalMap::write_counts(Map& map) {
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if ((visible_[i] | found_[i]) == 0) continue;
    if (MapPoint* point = map.find_point(points_[i])) {
      point->visible_count += visible_[i];
      point->found_count += found_[i];
    }
    visible_[i] = found_[i] = 0;
  }
}

}  // namespace holdfast
