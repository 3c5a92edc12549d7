// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <string>

#include "holdfast/evaluation/number_text.hpp"

namespace holdfast {

/// An error for people to read: at least three digits, and four decimals if they hold that many; what is below 1e-9 is
/// rounding and shown as 0.0000; "-" for none.
inline std::string error_text(double value) {
  const double magnitude = std::abs(value);
  if (!std::isfinite(value)) return "-";
  if (magnitude >= 1e-9 && magnitude < 1e-4) return scientific_text(value, 2);
  return fixed_text(value, magnitude >= 0.01 || magnitude < 1e-9 ? 4 : magnitude >= 0.001 ? 5 : 6);
}

/// A probability for people to read; what would be shown as 0 is bounded.
inline std::string probability_text(double value) { return value < 5e-5 ? "< 0.0001" : fixed_text(value, 4); }
/// "p = 0.0312", "p < 0.0001".
inline std::string p_text(double value) { return value < 5e-5 ? "p < 0.0001" : "p = " + fixed_text(value, 4); }

/// "12.3 %"; "-" for none.
inline std::string percent_text(double percent, int decimals) {
  return std::isfinite(percent) ? fixed_text(percent, decimals) + " %" : "-";
}

}  // namespace holdfast
