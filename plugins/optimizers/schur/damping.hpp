// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

namespace holdfast::schur_plugin {

/// Damping of Levenberg-Marquardt, relative to the diagonal of the Hessian: it falls with the gain ratio (actual over
/// predicted decrease of the cost), and rises faster with each rejected step (Madsen, Nielsen and Tingleff, "Methods
/// for non-linear least squares problems", 2004, section 3.2).
class Damping {
 public:
  double value() const { return value_; }
  bool is_hopeless() const { return value_ > 1e16; }

  /// A step was accepted; `gain` is the gain ratio.
  void accept(double gain) {
    const double shape = 2.0 * gain - 1.0;
    value_ = std::max(1e-16, value_ * std::max(1.0 / 3.0, 1.0 - shape * shape * shape));
    growth_ = 2.0;
  }
  void refuse() {
    value_ *= growth_;
    growth_ *= 2.0;
  }

 private:
  double value_ = 1e-4;
  double growth_ = 2.0;
};

/// Minimum gain ratio of an accepted step.
inline constexpr double minimum_gain = 1e-3;

}  // namespace holdfast::schur_plugin
