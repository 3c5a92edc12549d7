// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>

#include "holdfast/plugin/plugin.hpp"

HOLDFAST_PLUGIN(thrower, registry) {
  if (registry.kinds().size() < 1000) throw std::runtime_error("no licence file");
}
