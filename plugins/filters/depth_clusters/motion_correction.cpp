// SPDX-License-Identifier: BSD-3-Clause
#include "motion_correction.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "holdfast/geometry/se3.hpp"

namespace holdfast::cluster_plugin {

namespace {

using Vector6f = Eigen::Matrix<float, 6, 1>;
using Matrix6f = Eigen::Matrix<float, 6, 6>;

/// Normal equations of the blocks of every second row and column.
void sum_up(const BlockGrid& grid, const DepthView& now, const DepthView& past, const std::vector<float>& trust,
            const DepthNoise& noise, float scale, const Eigen::Isometry3d& motion, Matrix6f& H, Vector6f& g) {
  constexpr float grey_noise = 6.0F, grey_slope = 0.3F;
  const Eigen::Matrix3f R = motion.linear().cast<float>();
  const Eigen::Vector3f t = motion.translation().cast<float>();
  H.setZero();
  g.setZero();
  const float block_x = grid.fx * grid.inverse_step, block_y = grid.fy * grid.inverse_step;
  for (int row = 1; row < grid.rows; row += 2)
    for (int column = 1; column < grid.columns; column += 2) {
      const std::size_t block = static_cast<std::size_t>(row * grid.columns + column);
      const float depth = now.depth[block];
      if (depth <= 0.0F || trust[block] < 0.05F) continue;
      const Eigen::Vector3f ray(grid.ray_x[static_cast<std::size_t>(column)], grid.ray_y[static_cast<std::size_t>(row)],
                                1.0F);
      const Eigen::Vector3f p = depth * (R * ray) + t;
      if (p.z() < 0.1F) continue;
      const float inverse = 1.0F / p.z();
      const Surface there = surface_at(grid, past, grid.column_of(grid.fx * p.x() * inverse + grid.cx),
                                       grid.row_of(grid.fy * p.y() * inverse + grid.cy));
      if (!there.known || !there.smooth) continue;
      const float residual = there.depth - p.z();
      const float sigma = scale * noise.at(p.z());
      if (std::abs(residual) > 6.0F * sigma) continue;
      // Columns and rows by the motion: left perturbation, translation first.
      Vector6f du, dv, dz;
      const float xz = p.x() * inverse, yz = p.y() * inverse;
      du << inverse, 0.0F, -xz * inverse, -xz * yz, 1.0F + xz * xz, -yz;
      dv << 0.0F, inverse, -yz * inverse, -1.0F - yz * yz, xz * yz, xz;
      dz << 0.0F, 0.0F, 1.0F, p.y(), -p.x(), 0.0F;
      du *= block_x;
      dv *= block_y;
      const float weight = trust[block] * std::min(p.z(), 4.0F);
      const Vector6f jacobian = there.depth_x * du + there.depth_y * dv - dz;
      const float r = residual / sigma;
      const float w = weight / ((1.0F + r * r) * sigma * sigma);
      const float grey_sigma = grey_noise + grey_slope * (std::abs(there.grey_x) + std::abs(there.grey_y));
      const float grey_residual = there.grey - now.grey[block];
      const Vector6f grey_jacobian = there.grey_x * du + there.grey_y * dv;
      const float rg = grey_residual / grey_sigma;
      const float wg = weight / ((1.0F + r * r) * (1.0F + rg * rg) * grey_sigma * grey_sigma);
      for (int i = 0; i < 6; ++i) {
        const float a = w * jacobian[i], b = wg * grey_jacobian[i];
        g[i] -= a * residual + b * grey_residual;
        for (int j = 0; j <= i; ++j) H(i, j) += a * jacobian[j] + b * grey_jacobian[j];
      }
    }
}

}  // namespace

bool correct_motion(const BlockGrid& grid, const DepthView& now, const DepthView& past, const std::vector<float>& trust,
                    const DepthNoise& noise, double largest, Eigen::Isometry3d& motion) {
  if (largest <= 0.0) return true;
  Eigen::Isometry3d corrected = motion;
  Matrix6f H;
  Vector6f g;
  for (const float scale : {3.0F, 1.5F, 1.0F}) {
    sum_up(grid, now, past, trust, noise, scale, corrected, H, g);
    // What the images do not show stays as predicted: a millimetre or so by which predictions err.
    constexpr float hold_translation = 1.0F / (0.01F * 0.01F), hold_rotation = 1.0F / (0.005F * 0.005F);
    for (int i = 0; i < 6; ++i) H(i, i) += i < 3 ? hold_translation : hold_rotation;
    const geometry::Vector6d step = H.selfadjointView<Eigen::Lower>().ldlt().solve(g).cast<double>();
    if (!step.allFinite()) return false;
    corrected = geometry::exp_se3(step) * corrected;
  }
  const geometry::Vector6d change = geometry::log_se3(corrected * motion.inverse());
  if (change.head<3>().norm() > largest || change.tail<3>().norm() > 2.0 * largest) return false;
  motion = corrected;
  return true;
}

}  // namespace holdfast::cluster_plugin
