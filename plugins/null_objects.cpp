// SPDX-License-Identifier: BSD-3-Clause
// The modules that stand for "nothing", so that a configuration can say so: `segmenter: none`; and the default matcher,
// which is always there.
#include "holdfast/interfaces/feature_matcher.hpp"
#include "holdfast/interfaces/loop_detector.hpp"
#include "holdfast/interfaces/segmenter.hpp"
#include "holdfast/plugin/plugin.hpp"

HOLDFAST_PLUGIN(null_objects, registry) {
  using namespace holdfast;
  registry.add<Segmenter, NoSettings>(
      {.name = "none", .summary = "Finds nothing; the default."},
      [](const NoSettings&, const CreationContext&) { return std::make_unique<NullSegmenter>(); });
  registry.add<LoopDetector, NoSettings>(
      {.name = "none", .summary = "Recognises no place; the default."},
      [](const NoSettings&, const CreationContext&) { return std::make_unique<NullLoopDetector>(); });
  registry.add<FeatureMatcher, NoSettings>(
      {.name = "nearest",
       .summary = "Nearest descriptors, by the rules of each part of the pipeline; the default.",
       .paper = "Mur-Artal, Montiel and Tardos: ORB-SLAM. IEEE Transactions on Robotics 31(5), 2015"},
      [](const NoSettings&, const CreationContext&) { return std::make_unique<NearestMatcher>(); });
}
