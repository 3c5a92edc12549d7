// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "holdfast/core/check.hpp"

namespace holdfast {

/// Upper median: the central value, or the larger one of two central values. Requires at least one value, and reorders
/// them.
template <class Value>
Value upper_median(std::vector<Value>& values) {
  HOLDFAST_CHECK(!values.empty(), "a median of no values");
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace holdfast
