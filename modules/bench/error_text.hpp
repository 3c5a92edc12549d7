// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <string>

#include "holdfast/evaluation/number_text.hpp"

namespace holdfast {

/// An error for people to read: four decimals, and up to six where fewer than three digits would be left; "-" for none.
inline std::string error_text(double value) {
  const double magnitude = std::abs(value);
  if (!std::isfinite(value)) return "-";
  return fixed_text(value, magnitude >= 0.01 || magnitude < 5e-7 ? 4 : magnitude >= 0.001 ? 5 : 6);
}

/// "12.3 %"; "-" for none.
inline std::string percent_text(double percent, int decimals) {
  return std::isfinite(percent) ? fixed_text(percent, decimals) + " %" : "-";
}

}  // namespace holdfast
