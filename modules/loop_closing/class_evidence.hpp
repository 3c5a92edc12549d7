// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/interfaces/place_weights.hpp"
#include "place_points.hpp"

namespace holdfast {

/// What the classes of matched points and features say about a loop candidate.
struct ClassEvidence {
  double inliers = 0.0;   ///< sum of the weights of the matches
  double expected = 0.0;  ///< sum of the weights of the points that are predicted to be visible
  /// Matches that count at least half, for the coverage of the image.
  std::vector<matching::FeatureMatch> solid;
  int compared = 0;        ///< matches of a point with votes and a feature with a label
  double agreement = 1.0;  ///< mean share of the point's votes for the class of the feature over `compared`; 1 without
};

/// Weights the matches (source: point, feature: feature of the frame) and the visible points of a place by class. A
/// match has the lower weight of the feature's class and of the point's, which is the most frequent one of its votes;
/// what has no class has the weight 1. With uniform weights, all weights are 1 and classes are not compared.
ClassEvidence class_evidence(const Frame& frame, const PlacePoints& place, std::span<const std::uint32_t> visible,
                             std::span<const matching::FeatureMatch> matches, const PlaceWeights& weights);

}  // namespace holdfast
