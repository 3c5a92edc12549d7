// SPDX-License-Identifier: BSD-3-Clause
#include "mutual_ratio.hpp"

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

void MutualRatioSettings::describe(ParameterTable<MutualRatioSettings>& table) {
  using S = MutualRatioSettings;
  table.add("ratio", &S::ratio, "smallest to second smallest distance of descriptors, at most").range(0.1, 1);
  table
      .add("distance_factor", &S::distance_factor,
           "factor on the largest distance of descriptors that each part of the pipeline accepts")
      .range(0.1, 100);
}

}  // namespace holdfast

namespace holdfast::mutual_ratio_plugin {

void MutualRatioMatcher::match(const MatchSide& queries, const MatchSide& references, const MatchLimits& limits,
                               std::vector<FeatureMatch>& matches) const {
  MatchLimits own = limits;
  own.max_distance *= static_cast<float>(settings_.distance_factor);
  own.ratio = static_cast<float>(settings_.ratio);
  own.mutual = true;
  NearestMatcher::match(queries, references, own, matches);
}

void MutualRatioMatcher::match_guided(const Frame& frame, const FrameSearch::Query& points,
                                      const matching::GuidedSearchSettings& settings,
                                      std::span<const std::uint8_t> usable, std::vector<FeatureMatch>& matches) const {
  matching::GuidedSearchSettings own = settings;
  own.max_distance *= static_cast<float>(settings_.distance_factor);
  own.ratio = static_cast<float>(settings_.ratio);
  NearestMatcher::match_guided(frame, points, own, usable, matches);
}

}  // namespace holdfast::mutual_ratio_plugin
