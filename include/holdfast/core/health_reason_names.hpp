// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "holdfast/core/frame_health.hpp"

namespace holdfast {

/// The reasons in a set, in the order of HealthReason.
inline std::vector<HealthReason> reasons_in(const HealthReasons& set) {
  std::vector<HealthReason> reasons;
  for (int i = 0; i < health_reason_count; ++i)
    if (const auto reason = static_cast<HealthReason>(i); set.has(reason)) reasons.push_back(reason);
  return reasons;
}

/// Their names.
inline std::vector<std::string> names_of(const HealthReasons& set) {
  std::vector<std::string> names;
  for (const HealthReason reason : reasons_in(set)) names.emplace_back(to_string(reason));
  return names;
}

}  // namespace holdfast
