// SPDX-License-Identifier: BSD-3-Clause
#include "class_evidence.hpp"

#include <algorithm>

namespace holdfast {

ClassEvidence class_evidence(const Frame& frame, const PlacePoints& place, std::span<const std::uint32_t> visible,
                             std::span<const matching::FeatureMatch> matches, const PlaceWeights& weights) {
  ClassEvidence result;
  if (weights.are_uniform()) {
    result.inliers = static_cast<double>(matches.size());
    result.expected = static_cast<double>(visible.size());
    result.solid.assign(matches.begin(), matches.end());
    return result;
  }
  const auto weight_of_point = [&](std::uint32_t point) {
    return place.votes.empty() ? 1.0F : weights.of(place.votes[point].winner());
  };
  for (const std::uint32_t point : visible) result.expected += static_cast<double>(weight_of_point(point));
  double agreement = 0.0;
  for (const matching::FeatureMatch& match : matches) {
    const std::uint8_t label = feature_label(frame, match.feature);
    const float weight = std::min(weights.of(label), weight_of_point(match.source));
    result.inliers += static_cast<double>(weight);
    if (weight >= 0.5F) result.solid.push_back(match);
    if (label == CellMask::unknown || place.votes.empty() || place.votes[match.source].empty()) continue;
    ++result.compared;
    agreement += place.votes[match.source].share(label);
  }
  if (result.compared > 0) result.agreement = agreement / result.compared;
  return result;
}

}  // namespace holdfast
