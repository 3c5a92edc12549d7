// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/core/module.hpp"
#include "holdfast/interfaces/feature_matcher.hpp"
#include "holdfast/settings/mutual_ratio.hpp"

namespace holdfast::mutual_ratio_plugin {

/// Mutual nearest neighbours with a lead over the second nearest, in every part of the pipeline alike (Lowe,
/// "Distinctive image features from scale-invariant keypoints", IJCV 60(2), 2004, section 7.1). Near a prediction, the
/// lead is required over the features of the same octave within the window.
class MutualRatioMatcher final : public NearestMatcher {
 public:
  explicit MutualRatioMatcher(const MutualRatioSettings& settings, const CreationContext& = {}) : settings_(settings) {}

  void match(const MatchSide& queries, const MatchSide& references, const MatchLimits& limits,
             std::vector<FeatureMatch>& matches) const override;
  void match_guided(const Frame& frame, const FrameSearch::Query& points,
                    const matching::GuidedSearchSettings& settings, std::span<const std::uint8_t> usable,
                    std::vector<FeatureMatch>& matches) const override;

 private:
  MutualRatioSettings settings_;
};

}  // namespace holdfast::mutual_ratio_plugin
