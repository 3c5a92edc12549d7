// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/map.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "holdfast/core/descriptor_distance.hpp"

namespace holdfast {

namespace {

/// Index of the descriptor with the smallest median distance to all, itself included; the first of equal ones.
std::size_t find_central(const DescriptorBlock& descriptors) {
  const std::size_t count = descriptors.size();
  std::vector<std::uint32_t> candidates(count);
  std::iota(candidates.begin(), candidates.end(), 0U);
  const auto half = static_cast<std::ptrdiff_t>((count - 1) / 2);
  std::size_t best = 0;
  float best_median = std::numeric_limits<float>::infinity();
  std::vector<float> distances(count * count, 0.0F), row(count);
  for (std::size_t i = 0; i < count; ++i) {
    float* of_this = &distances[i * count];
    descriptor_distances(descriptors, i, descriptors, std::span(candidates).subspan(i + 1), of_this + i + 1);
    for (std::size_t j = 0; j < i; ++j) of_this[j] = distances[j * count + i];
    // A smaller median has more distances below the best one, which costs less to count than the median to find.
    const auto is_below = [best_median](float distance) { return distance < best_median; };
    if (std::count_if(of_this, of_this + count, is_below) <= half) continue;
    row.assign(of_this, of_this + count);
    std::nth_element(row.begin(), row.begin() + half, row.end());
    best_median = row[static_cast<std::size_t>(half)], best = i;
  }
  return best;
}

}  // namespace

KeyFrameId Map::add_keyframe(Frame frame) {
  const KeyFrameId id = keyframes_.emplace();
  KeyFrame& keyframe = keyframes_.at(id);
  keyframe.sequence = next_sequence_++;
  keyframe.frame = std::move(frame);
  std::vector<MapPointId>& points = keyframe.frame.map_points;
  for (std::uint32_t feature = 0; feature < points.size(); ++feature) {
    MapPoint* point = points_.find(points[feature]);
    if (point == nullptr || feature_of(points[feature], id) >= 0) {
      points[feature] = MapPointId();
      continue;
    }
    point->observations.push_back({id, feature});
    if (!point->reference_keyframe.valid()) point->reference_keyframe = id;
  }
  return id;
}

MapPointId Map::add_point(const Eigen::Vector3d& position, std::uint64_t created_at) {
  const MapPointId id = points_.emplace();
  MapPoint& point = points_.at(id);
  point.position = position;
  point.created_at = created_at;
  return id;
}

void Map::add_observation(MapPointId point_id, KeyFrameId keyframe_id, std::uint32_t feature) {
  MapPoint& point = points_.at(point_id);
  MapPointId& slot = keyframes_.at(keyframe_id).frame.map_points.at(feature);
  HOLDFAST_CHECK(!slot.valid(), "feature " << feature << " already shows point " << slot.slot);
  HOLDFAST_CHECK(feature_of(point_id, keyframe_id) < 0,
                 "point " << point_id.slot << " is already seen by the keyframe");
  slot = point_id;
  point.observations.push_back({keyframe_id, feature});
  if (!point.reference_keyframe.valid()) point.reference_keyframe = keyframe_id;
}

void Map::remove_observation(MapPointId point_id, KeyFrameId keyframe_id) {
  MapPoint& point = points_.at(point_id);
  const auto found = std::find_if(point.observations.begin(), point.observations.end(),
                                  [&](const Observation& o) { return o.keyframe == keyframe_id; });
  if (found == point.observations.end()) return;
  keyframes_.at(keyframe_id).frame.map_points[found->feature] = MapPointId();
  point.observations.erase(found);
  if (point.observations.empty()) {
    points_.erase(point_id);
    return;
  }
  if (point.reference_keyframe == keyframe_id) point.reference_keyframe = point.observations.front().keyframe;
}

int Map::feature_of(MapPointId point_id, KeyFrameId keyframe_id) const {
  for (const Observation& observation : points_.at(point_id).observations)
    if (observation.keyframe == keyframe_id) return static_cast<int>(observation.feature);
  return -1;
}

void Map::update_point(MapPointId point_id) {
  MapPoint& point = points_.at(point_id);
  update_point_geometry(point_id);

  const auto descriptors_of = [&](const Observation& observation) -> const DescriptorBlock& {
    return keyframes_.at(observation.keyframe).frame.features.descriptors;
  };
  const Observation& first = point.observations[0];
  point.descriptor.clear();
  // The median of one or two distances is the 0 between a descriptor and itself.
  if (point.observations.size() <= 2) return point.descriptor.append(descriptors_of(first), first.feature);
  DescriptorBlock descriptors(descriptors_of(first).type());
  descriptors.reserve(point.observations.size());
  for (const Observation& observation : point.observations)
    descriptors.append(descriptors_of(observation), observation.feature);
  point.descriptor.append(descriptors, find_central(descriptors));
}

void Map::update_point_geometry(MapPointId point_id) {
  MapPoint& point = points_.at(point_id);
  HOLDFAST_CHECK(!point.observations.empty(), "point " << point_id.slot << " has no observation");
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  for (const Observation& observation : point.observations) {
    const Eigen::Isometry3d& T_camera_world = keyframes_.at(observation.keyframe).frame.T_camera_world;
    const Eigen::Vector3d centre = -(T_camera_world.linear().transpose() * T_camera_world.translation());
    direction += (point.position - centre).normalized();
  }
  point.viewing_direction = direction.normalized();

  const Frame& reference = keyframes_.at(point.reference_keyframe).frame;
  const std::size_t feature = static_cast<std::size_t>(feature_of(point_id, point.reference_keyframe));
  const double distance = (reference.T_camera_world * point.position).norm();
  const ScalePyramid& pyramid = *reference.pyramid;
  if (pyramid.levels() == 1) {
    // Without octaves, a descriptor is expected to be recognised until its patch has half or twice the size.
    constexpr float factor = 2.0F;
    point.maximum_distance = static_cast<float>(distance) * factor;
    point.minimum_distance = static_cast<float>(distance) / factor;
    return;
  }
  point.maximum_distance = static_cast<float>(distance) * pyramid.scale[reference.features.octave[feature]];
  point.minimum_distance = point.maximum_distance * pyramid.inverse_scale.back();
}

void Map::fuse_points(MapPointId from_id, MapPointId to_id) {
  if (from_id == to_id) return;
  const MapPoint from = points_.at(from_id);
  for (const Observation& observation : from.observations) {
    MapPointId& slot = keyframes_.at(observation.keyframe).frame.map_points[observation.feature];
    slot = MapPointId();
    if (feature_of(to_id, observation.keyframe) < 0) add_observation(to_id, observation.keyframe, observation.feature);
  }
  MapPoint& to = points_.at(to_id);
  to.visible_count += from.visible_count;
  to.found_count += from.found_count;
  if (to.label == CellMask::unknown) to.label = from.label;
  to.earlier_votes.add(from.earlier_votes);
  to.static_log_odds = std::clamp(to.static_log_odds + from.static_log_odds, -evidence_limit_, evidence_limit_);
  points_.erase(from_id);
  update_point(to_id);
}

void Map::remove_point(MapPointId point_id) {
  const MapPoint* point = points_.find(point_id);
  if (point == nullptr) return;
  for (const Observation& observation : point->observations)
    keyframes_.at(observation.keyframe).frame.map_points[observation.feature] = MapPointId();
  points_.erase(point_id);
}

void Map::remove_all() {
  for (const MapPointId id : points_.ids()) points_.erase(id);
  for (const KeyFrameId id : keyframes_.ids()) keyframes_.erase(id);
  removed_keyframes_.clear();
  next_sequence_ = 0;
  last_submap_ = 0;
  inertia_.reset();
  ++version_;
}

void Map::clear() {
  keyframes_.clear();
  points_.clear();
  removed_keyframes_.clear();
  next_sequence_ = 0;
  last_submap_ = 0;
  sensor_ = Sensor::rgbd;
  inertia_.reset();
  ++version_;
}

}  // namespace holdfast
