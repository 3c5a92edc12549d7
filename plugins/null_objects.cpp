// SPDX-License-Identifier: BSD-3-Clause
// The modules that stand for "nothing", so that a configuration can say so: `segmenter: none`.
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
}
