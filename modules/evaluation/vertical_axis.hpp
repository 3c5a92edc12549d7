// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

namespace holdfast {

/// The axis (0 = x, 1 = y, 2 = z) of the truth along which cameras that are carried upright feel gravity; empty where
/// they do not tell it. `mean_up` is that of an Evaluation.
inline std::optional<int> vertical_axis(const Eigen::Vector3d& mean_up) {
  int axis = 2;
  const double largest = mean_up.cwiseAbs().maxCoeff(&axis);
  constexpr double decisive = 0.7;  // within 45 degrees on average
  return largest > decisive ? std::optional(axis) : std::nullopt;
}

}  // namespace holdfast
