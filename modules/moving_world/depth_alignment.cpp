// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

#include "holdfast/core/depth_noise.hpp"
#include "holdfast/geometry/se3.hpp"
#include "holdfast/geometry/warp.hpp"
#include "holdfast/moving_world/depth_agreement.hpp"

namespace holdfast {

namespace {

/// A surface element of a keyframe in its depth camera's frame.
struct Surface {
  Eigen::Vector3f point;   // [m]
  Eigen::Vector3f normal;  // unit length
};

/// Reads surface elements from a keyframe's coarse view.
class SurfaceReader {
 public:
  SurfaceReader(const CoarseView& view, const geometry::Warp& rays) : view_(view), rays_(rays) {}

  /// Surface element of a cell; nothing at the border, without depth, on moving cells, and at depth edges.
  std::optional<Surface> at(int column, int row) const {
    const CoarseGrid& grid = view_.grid;
    if (column < 1 || row < 1 || column + 1 >= grid.columns || row + 1 >= grid.rows) return std::nullopt;
    const std::size_t cell = static_cast<std::size_t>(row * grid.columns + column);
    if (!view_.static_log_odds.empty() && view_.static_log_odds[cell] < 0.0F) return std::nullopt;
    const float depth = view_.depth[cell];
    if (depth == 0.0F) return std::nullopt;
    const float limit = depth_noise::continues_normal(depth);
    for (const auto& [c, r] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}})
      if (!(std::abs(depth_at(column + c, row + r) - depth) < limit)) return std::nullopt;
    const Eigen::Vector3f across = point_at(column + 1, row) - point_at(column - 1, row);
    const Eigen::Vector3f down = point_at(column, row + 1) - point_at(column, row - 1);
    const Eigen::Vector3f normal = across.cross(down);
    const float length = normal.norm();
    if (!(length > 0.0F)) return std::nullopt;
    return Surface{point_at(column, row), normal / length};
  }

 private:
  float depth_at(int column, int row) const {
    return view_.depth[static_cast<std::size_t>(row * view_.grid.columns + column)];
  }
  Eigen::Vector3f point_at(int column, int row) const {
    return depth_at(column, row) *
           Eigen::Vector3f(rays_.ray_x(view_.grid.x_of(column)), rays_.ray_y(view_.grid.y_of(row)), 1.0F);
  }

  const CoarseView& view_;
  const geometry::Warp& rays_;
};

}  // namespace

Eigen::Isometry3d DepthAgreement::align(const Frame& frame, const Eigen::Isometry3d& T_view_world) const {
  constexpr int iterations = 8, stride = 3;  // cells
  // Standard deviations of the predicted pose: errors of constant velocity over one frame in rapid motion.
  constexpr double sigma_metres = 0.03, sigma_radians = 0.03;
  const CoarseGrid& grid = frame.coarse.grid;
  const geometry::Pinhole camera = geometry::pinhole_of(*frame.camera);
  const geometry::Matrix6d prior =
      (geometry::Vector6d() << Eigen::Vector3d::Constant(1.0 / (sigma_metres * sigma_metres)),
       Eigen::Vector3d::Constant(1.0 / (sigma_radians * sigma_radians)))
          .finished()
          .asDiagonal();

  const Eigen::Isometry3d T_world_predicted = T_view_world.inverse();
  Eigen::Isometry3d T_world_view = T_world_predicted;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    // The gate narrows while the pose converges.
    const float gate = 0.05F + 0.10F / static_cast<float>(1 + iteration);
    geometry::Matrix6d hessian = prior;
    geometry::Vector6d gradient = prior * geometry::log_se3(T_world_predicted.inverse() * T_world_view);
    for (const Frame* keyframe : keyframes_) {
      if (!(keyframe->coarse.grid == grid)) continue;
      const Eigen::Isometry3d T_keyframe_view = keyframe->T_view_world() * T_world_view;
      const Eigen::Matrix3f R_view_keyframe = T_keyframe_view.linear().transpose().cast<float>();
      const geometry::Warp warp(T_keyframe_view, camera);
      const SurfaceReader surfaces(keyframe->coarse, warp);
      for (int row = stride / 2; row < grid.rows; row += stride)
        for (int column = stride / 2; column < grid.columns; column += stride) {
          const float depth = frame.coarse.depth[static_cast<std::size_t>(row * grid.columns + column)];
          if (depth == 0.0F) continue;
          const float ray_x = warp.ray_x(grid.x_of(column)), ray_y = warp.ray_y(grid.y_of(row));
          const auto warped = warp(ray_x, ray_y, depth);
          if (!warped) continue;
          const auto surface = surfaces.at(grid.column_of(warped->x), grid.row_of(warped->y));
          if (!surface) continue;
          const float residual = surface->normal.dot(warped->point - surface->point);
          if (std::abs(residual) > gate || std::abs(warped->point.z() - surface->point.z()) > 2.0F * gate) continue;
          // Huber's cost beyond two deviations.
          const float sigma = depth_noise::alignment_deviation(depth);
          const float weight = std::min(1.0F, 2.0F * sigma / std::max(std::abs(residual), 1e-6F)) / (sigma * sigma);
          const Eigen::Vector3f point = depth * Eigen::Vector3f(ray_x, ray_y, 1.0F);
          const Eigen::Vector3f direction = R_view_keyframe * surface->normal;
          geometry::Vector6d jacobian;
          jacobian << direction.cast<double>(), point.cross(direction).cast<double>();
          hessian.noalias() += static_cast<double>(weight) * (jacobian * jacobian.transpose());
          gradient.noalias() += static_cast<double>(weight * residual) * jacobian;
        }
    }
    const geometry::Vector6d step = hessian.ldlt().solve(-gradient);
    if (!step.allFinite()) break;
    T_world_view = T_world_view * geometry::exp_se3(step);
    if (step.norm() < 1e-4) break;
  }
  return T_world_view.inverse();
}

}  // namespace holdfast
