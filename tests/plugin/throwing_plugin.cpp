// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>

#include "holdfast/plugin/plugin.hpp"

HOLDFAST_PLUGIN(throwing, registry) {
  if (registry.kinds().empty()) throw std::runtime_error("no licence");
}
