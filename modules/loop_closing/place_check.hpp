// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "holdfast/loop_closing/loop_closing_settings.hpp"
#include "holdfast/loop_closing/loop_verdict.hpp"
#include "place_points.hpp"

namespace holdfast {

/// What the check of a candidate found.
struct CheckedPlace {
  LoopVerdict verdict = LoopVerdict::few_matches;
  Eigen::Isometry3d T_camera_world = Eigen::Isometry3d::Identity();  ///< of the keyframe, seen from the place's points
  std::vector<matching::FeatureMatch> inliers;                       ///< points of the place, features of the keyframe
  int matches = 0, aligned = 0, expected = 0, cells = 0;             ///< as in LoopTrial
  double scale = 1.0;  ///< length at the place that is 1 around the keyframe; 1 where depth is measured
};

/// Static features of a keyframe whose position is known.
struct SolidFeatures {
  std::vector<std::uint32_t> features;
  std::vector<Eigen::Vector3d> in_camera;  ///< by index of the frame's features; of others, 0
  bool with_scale = false;                 ///< positions are those of map points, whose scale may have drifted since
};

/// Features with depth; with one camera, features that show a point of the map. The caller holds the map's lock.
SolidFeatures solid_features(const Frame& frame, const Map& map);

/// Whether a keyframe sees the points of a place, and from where (Mur-Artal et al. 2015, section VII-B, with the rigid
/// motion that depth allows, Mur-Artal and Tardos 2017, section III-D, or the similarity of one camera): descriptors
/// matched without a guess, rigid 3D-3D alignment by RANSAC with the given seed, guided matching of all points of the
/// place, the pose adjusted to them with outliers set aside. Enough inliers, a share of what should be seen, and spread
/// over the image: accepted.
///
/// Needs no lock while nobody changes the keyframe: it reads the frame's features and the copied points.
CheckedPlace check_place(const LoopClosingSettings& settings, const FeatureMatcher& matcher, Optimizer& optimizer,
                         const Frame& frame, const SolidFeatures& solid, const PlacePoints& place, std::uint64_t seed);

}  // namespace holdfast
