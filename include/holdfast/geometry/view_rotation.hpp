// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>

#include "holdfast/geometry/so3.hpp"

namespace holdfast::geometry {

/// The rotation between two views that are so close to each other that their parallax is small: tangent vector w of
/// the R = exp(w) that minimises the sum of |b - R a| over pairs of unit rays (a, b) through matched features. Wrong
/// matches, up to nearly half of all, hardly change a minimum of absolute values, which reweighted least squares find
/// (Weiszfeld 1937). Empty with fewer than 20 pairs, or if the rays determine no rotation.
inline std::optional<Eigen::Vector3d> view_rotation(std::span<const Eigen::Vector3d> a,
                                                    std::span<const Eigen::Vector3d> b) {
  constexpr std::size_t minimum_pairs = 20;
  constexpr int iterations = 20;
  constexpr double exact = 1e-4;  // [rad]: a residual of this size has the largest weight
  if (a.size() != b.size() || a.size() < minimum_pairs) return std::nullopt;
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  for (int i = 0; i < iterations; ++i) {
    Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < a.size(); ++k) {
      const Eigen::Vector3d turned = rotation * a[k], residual = b[k] - turned;
      const double weight = 1.0 / std::max(residual.norm(), exact);
      hessian += weight * (Eigen::Matrix3d::Identity() - turned * turned.transpose());
      gradient += weight * turned.cross(residual);
    }
    const Eigen::LLT<Eigen::Matrix3d> factor(hessian);
    if (factor.info() != Eigen::Success || !(factor.rcond() > 1e-9)) return std::nullopt;
    const Eigen::Vector3d step = factor.solve(gradient);
    if (!step.allFinite()) return std::nullopt;
    rotation = (exp_so3(step) * rotation).normalized();
    if (step.norm() < 1e-7) break;
  }
  return log_so3(rotation);
}

}  // namespace holdfast::geometry
