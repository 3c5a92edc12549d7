// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <numbers>

namespace holdfast::simulation {

constexpr double degrees = std::numbers::pi / 180.0;

/// From 0 to 1 over the unit interval with zero speed and acceleration at both ends (minimum jerk; Flash and Hogan
/// 1985, equation 2.5), as hands and bodies move.
inline double ease(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * x * (10.0 + x * (-15.0 + 6.0 * x));
}

/// 0 at both ends of the unit interval, 1 in the middle, flat there and at the ends.
inline double bump(double x) {
  x = std::clamp(x, 0.0, 1.0);
  const double parabola = 4.0 * x * (1.0 - x);
  return parabola * parabola;
}

/// Something that comes, stays and goes again.
struct Window {
  double from, full, fading, gone;  ///< [s]

  /// 0 before, 1 from `full` to `fading`, 0 again from `gone` on; linear between.
  double raw(double time) const {
    if (time < full) return std::clamp((time - from) / (full - from), 0.0, 1.0);
    return std::clamp((gone - time) / (gone - fading), 0.0, 1.0);
  }
  double weight(double time) const { return ease(raw(time)); }
  bool contains(double time) const { return time > from && time < gone; }
};

}  // namespace holdfast::simulation
