// SPDX-License-Identifier: BSD-3-Clause
#include "rigid_alignment.hpp"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>

#include "holdfast/geometry/so3.hpp"

namespace holdfast::motion_objects_plugin {

using depth_blocks::Surface;

namespace {

constexpr float grey_noise = 6.0F, grey_slope = 0.3F;
/// Errors of adjacent blocks are correlated, and objects are non-rigid: this many blocks count as one independent one.
constexpr float together = 6.0F;

}  // namespace

RigidAlignment::NormalEquations RigidAlignment::linearise(const ObjectPoints& now, const DepthView& then,
                                                          const OwnedBlocks& owned, const RigidMotion& motion,
                                                          float scale) const {
  const float block_x = grid_.fx * grid_.inverse_step, block_y = grid_.fy * grid_.inverse_step;
  NormalEquations equations;
  for (std::size_t i = 0; i < now.points.size(); ++i) {
    const Eigen::Vector3f arm = motion.rotation * (now.points[i] - now.centre);
    const Eigen::Vector3f q = now.centre + motion.translation + arm;
    if (q.z() < 0.1F) continue;
    const float inverse = 1.0F / q.z();
    const float column = grid_.column_of(grid_.fx * q.x() * inverse + grid_.cx);
    const float row = grid_.row_of(grid_.fy * q.y() * inverse + grid_.cy);
    const Surface there = surface_at(grid_, then, column, row);
    if (!there.known || !there.smooth) continue;
    const std::size_t nearest =
        static_cast<std::size_t>(static_cast<int>(row + 0.5F) * grid_.columns + static_cast<int>(column + 0.5F));
    if (owned.owner[nearest] != owned.track_id) continue;
    const float sigma = 0.5F * scale * noise_.at(q.z());
    const float residual = there.depth - q.z();
    const float r = residual / sigma;
    if (std::abs(r) > 6.0F) continue;
    ++equations.inliers;
    const float grey_sigma = grey_noise + grey_slope * (std::abs(there.grey_x) + std::abs(there.grey_y));
    const float grey_residual = there.grey - now.grey[i];
    const float rg = grey_residual / grey_sigma;
    // Derivatives of column and row by the point, then of depth and brightness, then by the motion, translation
    // first.
    const Eigen::Vector3f du(block_x * inverse, 0.0F, -block_x * q.x() * inverse * inverse);
    const Eigen::Vector3f dv(0.0F, block_y * inverse, -block_y * q.y() * inverse * inverse);
    Vector6f jacobian, grey_jacobian;
    jacobian.head<3>() = there.depth_x * du + there.depth_y * dv - Eigen::Vector3f::UnitZ();
    jacobian.tail<3>() = arm.cross(jacobian.head<3>());
    grey_jacobian.head<3>() = there.grey_x * du + there.grey_y * dv;
    grey_jacobian.tail<3>() = arm.cross(grey_jacobian.head<3>());
    const float w = 1.0F / (together * sigma * sigma * (1.0F + r * r));
    const float wg = 1.0F / (together * grey_sigma * grey_sigma * (1.0F + r * r) * (1.0F + rg * rg));
    for (int a = 0; a < 6; ++a) {
      const float wa = w * jacobian[a], wga = wg * grey_jacobian[a];
      equations.g[a] -= wa * residual + wga * grey_residual;
      for (int b = 0; b <= a; ++b) equations.H(a, b) += wa * jacobian[b] + wga * grey_jacobian[b];
    }
  }
  return equations;
}

void RigidAlignment::add_prior(const Prior& prior, const RigidMotion& motion, NormalEquations& equations) {
  const float rotation_information = 1.0F / (prior.rotation_deviation * prior.rotation_deviation);
  const Eigen::Vector3f turned = geometry::log_so3(motion.rotation.cast<double>()).cast<float>();
  for (int a = 0; a < 3; ++a) {
    const float information = 1.0F / (prior.deviation[a] * prior.deviation[a]);
    equations.H(a, a) += information;
    equations.g[a] -= information * (motion.translation[a] - prior.translation[a]);
    equations.H(a + 3, a + 3) += rotation_information;
    equations.g[a + 3] -= rotation_information * turned[a];
  }
}

AlignmentResult RigidAlignment::align(const ObjectPoints& now, const DepthView& then, const OwnedBlocks& owned,
                                      const RigidMotion& start, const Prior& prior) const {
  AlignmentResult result;
  RigidMotion& motion = result.motion;
  motion = start;
  constexpr std::array<float, 6> scales{4.0F, 2.5F, 1.5F, 1.0F, 1.0F, 1.0F};
  NormalEquations equations;
  for (const float scale : scales) {
    equations = linearise(now, then, owned, motion, scale);
    result.inliers = equations.inliers;
    add_prior(prior, motion, equations);
    const Vector6f step = equations.H.selfadjointView<Eigen::Lower>().ldlt().solve(equations.g);
    if (!step.allFinite()) break;
    motion.translation += step.head<3>();
    motion.rotation =
        geometry::exp_so3(step.tail<3>().cast<double>()).toRotationMatrix().cast<float>() * motion.rotation;
  }
  const Matrix6f covariance = Matrix6f(equations.H.selfadjointView<Eigen::Lower>()).inverse();
  result.covariance = covariance.topLeftCorner<3, 3>();
  result.rotation_covariance = covariance.bottomRightCorner<3, 3>();
  return result;
}

}  // namespace holdfast::motion_objects_plugin
