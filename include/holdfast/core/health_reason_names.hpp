// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "holdfast/core/frame_health.hpp"

namespace holdfast {

/// Names of the reasons in a set, in the order of HealthReason.
inline std::vector<std::string> names_of(const HealthReasons& reasons) {
  std::vector<std::string> names;
  for (int i = 0; i < health_reasons; ++i)
    if (const auto reason = static_cast<HealthReason>(i); reasons.has(reason)) names.emplace_back(to_string(reason));
  return names;
}

}  // namespace holdfast
