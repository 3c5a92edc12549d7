// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "holdfast/interfaces/place_weights.hpp"
#include "holdfast/loop_closing/loop_closing_settings.hpp"
#include "holdfast/loop_closing/loop_verdict.hpp"
#include "place_points.hpp"

namespace holdfast {

/// Result of the geometric verification of a candidate.
struct CheckedPlace {
  LoopVerdict verdict = LoopVerdict::few_matches;
  Eigen::Isometry3d T_camera_world = Eigen::Isometry3d::Identity();  ///< of the keyframe, from the candidate's points
  std::vector<matching::FeatureMatch> inliers;                       ///< candidate's points, keyframe's features
  int matches = 0, aligned = 0, expected = 0, cells = 0;             ///< as in CandidateReport
  double class_agreement = 1.0;                                      ///< as in CandidateReport
  double scale = 1.0;  ///< scale of the Sim(3) from keyframe to candidate; 1 if depth is measured
};

/// Static features of a keyframe with a known 3-D position.
struct LocatedFeatures {
  std::vector<std::uint32_t> features;
  std::vector<Eigen::Vector3d> in_camera;  ///< by index of the frame's features; of others, 0
  bool scale_is_free = false;              ///< positions are those of map points, whose scale may have drifted
};

/// Features with depth; with one camera, features with a map point.
LocatedFeatures located_features(const Frame& frame, const Map& map);

/// Geometric verification of a loop candidate (Mur-Artal et al. 2015, section VII-B; with depth an SE(3) alignment,
/// Mur-Artal and Tardos 2017, section III-D; with one camera a Sim(3)): descriptor matching, 3D-3D alignment by RANSAC
/// with the given seed, guided search for all points of the candidate, and motion-only adjustment. Accepted with enough
/// inliers, a minimum share of the points predicted to be visible, and coverage of the image. With weights of classes,
/// inliers and visible points count by them, and their classes must agree (class_evidence.hpp).
///
/// Needs no lock while the keyframe is not changed: it reads the frame's features and the copied points.
CheckedPlace check_place(const LoopClosingSettings& settings, const FeatureMatcher& matcher, Optimizer& optimizer,
                         const Frame& frame, const LocatedFeatures& located, const PlacePoints& place,
                         std::uint64_t seed, const PlaceWeights& weights = {});

}  // namespace holdfast
