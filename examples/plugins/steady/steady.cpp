// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "holdfast/interfaces/feature_matcher.hpp"
#include "holdfast/plugin/plugin.hpp"

using namespace holdfast;

struct SteadySettings {
  double reach = 0.25;
  static void describe(ParameterTable<SteadySettings>& table) {
    table.add("reach", &SteadySettings::reach, "share of the image's width by which a feature may move").range(0, 2);
  }
};

/// The nearest descriptors, as `nearest` finds them, unless the feature would have jumped across the image.
struct Steady final : NearestMatcher {
  Steady(const SteadySettings& settings, const CreationContext&) : reach(settings.reach) {}

  void match(const MatchSide& queries, const MatchSide& references, const MatchLimits& limits,
             std::vector<FeatureMatch>& matches) const override {
    NearestMatcher::match(queries, references, limits, matches);
    if (queries.x.empty() || references.x.empty()) return;  // points of a map have no place in an image
    std::erase_if(matches, [&](const FeatureMatch& match) {
      return std::hypot(queries.x[match.source] - references.x[match.feature],
                        queries.y[match.source] - references.y[match.feature]) > reach * references.width;
    });
  }
  double reach;
};

HOLDFAST_PLUGIN(steady, registry) {
  registry.add<FeatureMatcher, Steady, SteadySettings>(
      {.name = "steady", .summary = "Nearest descriptors of features that stay near their place in the image."});
}
