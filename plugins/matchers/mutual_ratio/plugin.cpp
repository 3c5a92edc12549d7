// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/plugin.hpp"

#include "mutual_ratio.hpp"

HOLDFAST_PLUGIN(mutual_ratio, registry) {
  registry
      .add<holdfast::FeatureMatcher, holdfast::mutual_ratio_plugin::MutualRatioMatcher, holdfast::MutualRatioSettings>(
          {.name = holdfast::MutualRatioSettings::module,
           .summary = "Mutual nearest descriptors with a lead over the second nearest, in every part of the pipeline.",
           .paper = "Lowe: Distinctive image features from scale-invariant keypoints. IJCV 60(2), 2004"});
}
