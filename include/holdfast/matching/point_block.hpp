// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "holdfast/core/map.hpp"
#include "holdfast/matching/descriptors.hpp"
#include "holdfast/matching/traits.hpp"

namespace holdfast {

/// Map points for a guided search as flat arrays, so that thousands of points are projected in one pass over memory and
/// matched without the lock of the map. Entry i of each array belongs to point i.
struct PointBlock {
  std::vector<MapPointId> ids;
  std::vector<float> x, y, z;                                ///< world [m]
  std::vector<float> direction_x, direction_y, direction_z;  ///< unit mean viewing direction, world
  std::vector<float> min_distance, max_distance;             ///< distance range of descriptor matching [m]
  DescriptorBlock descriptors;

  std::size_t size() const { return ids.size(); }
  void clear();
  void add(MapPointId id, const MapPoint& point);
};

/// Returns every point that the keyframes observe once, in the order of the keyframes and of their features.
std::vector<MapPointId> points_seen_by(const Map& map, std::span<const KeyFrameId> keyframes);

namespace matching {

/// A PointBlock as points of a guided search.
template <>
struct PointTraits<PointBlock> {
  static std::size_t size(const PointBlock& points) { return points.size(); }
  static Eigen::Vector3f position(const PointBlock& points, std::uint32_t i) {
    return {points.x[i], points.y[i], points.z[i]};
  }
  static Eigen::Vector3f direction(const PointBlock& points, std::uint32_t i) {
    return {points.direction_x[i], points.direction_y[i], points.direction_z[i]};
  }
  static float min_distance(const PointBlock& points, std::uint32_t i) { return points.min_distance[i]; }
  static float max_distance(const PointBlock& points, std::uint32_t i) { return points.max_distance[i]; }
};

}  // namespace matching

}  // namespace holdfast
