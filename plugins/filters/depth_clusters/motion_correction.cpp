// SPDX-License-Identifier: BSD-3-Clause
#include "motion_correction.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "holdfast/geometry/se3.hpp"

namespace holdfast::depth_clusters_plugin {

using depth_blocks::Surface;

/// Normal equations of every second row and column of blocks. Returns the mean cost, between 0 and 1, of the surface
/// that both views show.
float MotionCorrection::sum_up(const DepthView& now, const DepthView& past, const std::vector<float>& trust,
                               const Pass& pass, const Eigen::Isometry3d& motion) {
  constexpr float grey_noise = 6.0F, grey_slope = 0.3F;
  const geometry::Warp warp = grid_.warp(motion);
  const float block_x = grid_.fx * grid_.inverse_step, block_y = grid_.fy * grid_.inverse_step;
  float cost = 0.0F, all = 1e-6F;
  H_.setZero();
  g_.setZero();
  for (int row = 1; row < grid_.rows; row += 2)
    for (int column = 1; column < grid_.columns; column += 2) {
      const std::size_t block = static_cast<std::size_t>(row * grid_.columns + column);
      const float depth = now.depth[block];
      if (depth <= 0.0F || trust[block] < 0.05F) continue;
      const auto warped = grid_.warped(warp, column, row, depth);
      if (!warped) continue;
      const Eigen::Vector3f& p = warped->point;
      const float inverse = 1.0F / p.z();
      const Surface there = surface_at(grid_, past, grid_.column_of(warped->x), grid_.row_of(warped->y));
      if (!there.known || !there.smooth) continue;
      const float residual = there.depth - p.z();
      const float noise = noise_.at(p.z());
      const float grey_sigma = grey_noise + grey_slope * (std::abs(there.grey_x) + std::abs(there.grey_y));
      const float grey_residual = there.grey - now.grey[block];
      const float surface = trust[block] * surface_of(p.z());
      {
        const float r = 2.0F * residual / noise, rg = grey_residual / grey_sigma;
        const float r2 = r * r + rg * rg;
        cost += surface * r2 / (1.0F + r2);
        all += surface;
      }
      if (pass.only_cost) continue;
      const float sigma = pass.scale * noise;
      if (std::abs(residual) > 6.0F * sigma) continue;
      // Derivatives of column, row and depth by the motion: left perturbation, translation first.
      const float xz = p.x() * inverse, yz = p.y() * inverse;
      Vector6f du, dv, dz;
      du << inverse, 0.0F, -xz * inverse, -xz * yz, 1.0F + xz * xz, -yz;
      dv << 0.0F, inverse, -yz * inverse, -1.0F - yz * yz, xz * yz, xz;
      dz << 0.0F, 0.0F, 1.0F, p.y(), -p.x(), 0.0F;
      du *= block_x;
      dv *= block_y;
      const float r = residual / sigma, rg = grey_residual / grey_sigma;
      constexpr float typical_noise = 0.02F;  // m
      const float depth_weight = pass.weighting == Weighting::by_surface ? surface / (typical_noise * typical_noise)
                                                                         : trust[block] * p.z() / (sigma * sigma);
      const float grey_weight = pass.weighting == Weighting::by_surface ? surface : trust[block] * p.z();
      const float w = depth_weight / (1.0F + r * r);
      const float wg = grey_weight / ((1.0F + r * r) * (1.0F + rg * rg) * grey_sigma * grey_sigma);
      const Vector6f jacobian = there.depth_x * du + there.depth_y * dv - dz;
      const Vector6f grey_jacobian = there.grey_x * du + there.grey_y * dv;
      for (int i = 0; i < 6; ++i) {
        const float a = w * jacobian[i], b = wg * grey_jacobian[i];
        g_[i] -= a * residual + b * grey_residual;
        for (int j = 0; j <= i; ++j) H_(i, j) += a * jacobian[j] + b * grey_jacobian[j];
      }
    }
  return cost / all;
}

bool MotionCorrection::descend(const DepthView& now, const DepthView& past, const std::vector<float>& trust,
                               Weighting weighting, Eigen::Isometry3d& motion, float& cost) {
  const Eigen::Isometry3d start = motion;
  constexpr std::array<float, 3> scales{1.5F, 1.0F, 1.0F};
  for (const float scale : scales) {
    sum_up(now, past, trust, {weighting, scale}, motion);
    // Directions that the images do not constrain keep the prediction.
    constexpr float hold_translation = 1.0F / (0.01F * 0.01F), hold_rotation = 1.0F / (0.005F * 0.005F);
    for (int i = 0; i < 6; ++i) H_(i, i) += i < 3 ? hold_translation : hold_rotation;
    const geometry::Vector6d step = H_.selfadjointView<Eigen::Lower>().ldlt().solve(g_).cast<double>();
    if (!step.allFinite()) return false;
    motion = geometry::exp_se3(step) * motion;
  }
  cost = sum_up(now, past, trust, {weighting, scales.back(), true}, motion);
  const geometry::Vector6d change = geometry::log_se3(motion * start.inverse());
  return change.head<3>().norm() <= largest_ && change.tail<3>().norm() <= 2.0 * largest_;
}

bool MotionCorrection::correct(const DepthView& now, const DepthView& past, const std::vector<float>& trust,
                               Eigen::Isometry3d& motion) {
  if (largest_ <= 0.0) return true;
  Eigen::Isometry3d by_noise = motion, by_surface = motion;
  float cost_by_noise = 1.0F, cost_by_surface = 1.0F;
  const bool first = descend(now, past, trust, Weighting::by_noise, by_noise, cost_by_noise);
  const bool second = descend(now, past, trust, Weighting::by_surface, by_surface, cost_by_surface);
  constexpr float clearly = 0.8F;
  if (second && (!first || cost_by_surface < clearly * cost_by_noise))
    motion = by_surface;
  else if (first)
    motion = by_noise;
  return first || second;
}

}  // namespace holdfast::depth_clusters_plugin
