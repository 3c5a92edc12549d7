// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "holdfast/core/map.hpp"
#include "holdfast/interfaces/feature_matcher.hpp"
#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/matching/point_block.hpp"

namespace holdfast {

/// Map points copied so that they can be matched and aligned without the map's lock. Entry i of each belongs to point
/// i.
struct PlacePoints {
  PointBlock block;
  std::vector<Eigen::Vector3d> positions;  ///< world [m], in double precision for the alignment
  std::vector<ClassVotes> votes;           ///< histograms of their classes, see copy_votes(); empty = not copied

  std::size_t size() const { return positions.size(); }
  void add(MapPointId id, const MapPoint& point) {
    block.add(id, point);
    positions.push_back(point.position);
  }
};

/// Copies every point that the keyframes observe, in the order of points_seen_by().
PlacePoints copy_points_seen_by(const Map& map, std::span<const KeyFrameId> keyframes);

/// Copies the class histograms of the points, which must be in the map.
void copy_votes(const Map& map, PlacePoints& points);

/// Result of the guided search for the points of a candidate in a frame.
struct PointSearch {
  std::vector<matching::FeatureMatch> matches;  ///< by feature; each feature and each point at most once
  int expected = 0;                             ///< points predicted to be visible in the frame
  std::vector<std::uint32_t> visible;           ///< these points, by their index
};

/// Guided search: projects the points with T_camera_world and looks for the nearest descriptor within `radius` pixels
/// (times the scale of the expected octave), at most `max_distance` away; 0 = as LoopClosingSettings::match_distance.
/// Reads only data of the frame that are constant after it became a keyframe.
PointSearch find_points(const FeatureMatcher& matcher, const PointBlock& points, const Frame& frame,
                        const Eigen::Isometry3d& T_camera_world, double radius, double max_distance);

/// LoopClosingSettings::match_distance, or its default for these descriptors if it is 0.
float match_distance(double configured, const DescriptorType& type);

/// The pose problem of matched points and features.
PoseProblem pose_problem_of(const PlacePoints& points, const Frame& frame,
                            std::span<const matching::FeatureMatch> matches, const Eigen::Isometry3d& T_camera_world);

}  // namespace holdfast
