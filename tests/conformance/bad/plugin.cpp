// SPDX-License-Identifier: BSD-3-Clause
// Modules that break one promise each: what the conformance suite must find.
#include "holdfast/plugin/plugin.hpp"
#include "bad/faulty.hpp"

HOLDFAST_PLUGIN(bad_modules, registry) {
  holdfast::bad::add_extractors(registry);
  holdfast::bad::add_segmenters(registry);
  holdfast::bad::add_filters(registry);
  holdfast::bad::add_optimizers(registry);
  holdfast::bad::add_loop_detectors(registry);
}
