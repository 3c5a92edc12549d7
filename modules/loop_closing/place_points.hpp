// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "holdfast/core/map.hpp"
#include "holdfast/interfaces/optimizer.hpp"

namespace holdfast {

/// Map points copied into flat arrays, so that they can be matched without the map's lock. Entry i of each belongs to
/// point i.
struct PlacePoints {
  std::vector<MapPointId> ids;
  std::vector<Eigen::Vector3d> positions;   ///< world [m]
  std::vector<Eigen::Vector3d> directions;  ///< mean viewing direction, world
  std::vector<float> minimum_distance, maximum_distance;
  std::vector<Descriptor> descriptors;

  std::size_t size() const { return ids.size(); }
  void add(MapPointId id, const MapPoint& point);
};

/// All points that the keyframes see, each once, in the order of the keyframes and their features.
PlacePoints points_seen_by(const Map& map, std::span<const KeyFrameId> keyframes);

/// A point of PlacePoints and the feature of the frame that shows it.
struct PointMatch {
  std::uint32_t point = 0;
  std::uint32_t feature = 0;
  int distance = 0;  ///< [bits]
};

struct PointSearch {
  std::vector<PointMatch> matches;  ///< by feature; each feature and each point at most once
  int expected = 0;                 ///< points that the frame should show
};

/// Guided matching: projects the points with T_camera_world and looks for the nearest descriptor within `radius` pixels
/// (times the scale of the expected level), at most `maximum_distance` bits away. Reads of the frame only what does not
/// change once it is a keyframe.
PointSearch find_points(const PlacePoints& points, const Frame& frame, const Eigen::Isometry3d& T_camera_world,
                        double radius, int maximum_distance);

/// The pose problem of matched points and features.
PoseProblem pose_problem_of(const PlacePoints& points, const Frame& frame, std::span<const PointMatch> matches,
                            const Eigen::Isometry3d& T_camera_world);

}  // namespace holdfast
