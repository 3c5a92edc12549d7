// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/surface_alignment.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "holdfast/core/depth_noise.hpp"
#include "holdfast/geometry/se3.hpp"

namespace holdfast {

namespace {

using geometry::Matrix6d;
using geometry::Vector6d;

constexpr int iterations = 10, stride = 3;  // cells
// Standard deviations of the predicted pose: errors of constant velocity over one frame in rapid motion.
constexpr double sigma_metres = 0.03, sigma_radians = 0.03;
constexpr float least_slope = 0.3F;      // of the field, which is 1 where it is a distance
constexpr int fewest_cells = 150;        // on the surface
constexpr double least_agreement = 0.7;  // share of the cells near the surface that are on it

/// The static points of a view, in its frame [m].
std::vector<Eigen::Vector3f> static_points(const CoarseView& view, const Camera& camera) {
  std::vector<Eigen::Vector3f> points;
  const CoarseGrid& grid = view.grid;
  for (int row = stride / 2; row < grid.rows; row += stride)
    for (int column = stride / 2; column < grid.columns; column += stride) {
      const auto cell = static_cast<std::size_t>(row * grid.columns + column);
      const float depth = view.depth[cell];
      if (depth == 0.0F || (!view.static_log_odds.empty() && view.static_log_odds[cell] < 0.0F)) continue;
      const auto x = static_cast<double>(grid.x_of(column)), y = static_cast<double>(grid.y_of(row));
      points.push_back(camera.back_project(x, y, static_cast<double>(depth)).cast<float>());
    }
  return points;
}

/// The normal equations of the points at a pose, and how many of them are near the surface and on it.
struct Equations {
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  int near = 0, on_surface = 0;

  Equations(const SurfaceField& field, const std::vector<Eigen::Vector3f>& points,
            const Eigen::Isometry3d& T_world_view) {
    const Eigen::Isometry3f T = T_world_view.cast<float>();
    for (const Eigen::Vector3f& point : points) {
      const auto sample = field.sample(T * point);
      if (!sample || sample->slope.squaredNorm() < least_slope * least_slope) continue;
      const float sigma = depth_noise::alignment_deviation(point.z()), length = std::abs(sample->distance);
      ++near;
      on_surface += length < sigma ? 1 : 0;
      // Huber's cost beyond two deviations.
      const float weight = std::min(1.0F, 2.0F * sigma / std::max(length, 1e-6F)) / (sigma * sigma);
      const Eigen::Vector3f direction = T.linear().transpose() * sample->slope;
      Vector6d jacobian;
      jacobian << direction.cast<double>(), point.cross(direction).cast<double>();
      hessian.noalias() += static_cast<double>(weight) * (jacobian * jacobian.transpose());
      gradient.noalias() += static_cast<double>(weight * sample->distance) * jacobian;
    }
  }
};

}  // namespace

std::optional<Eigen::Isometry3d> align_with_surface(const SurfaceField& field, const CoarseView& view,
                                                    const Camera& camera, const Eigen::Isometry3d& T_view_world) {
  if (view.empty()) return std::nullopt;
  const Matrix6d prior = (Vector6d() << Eigen::Vector3d::Constant(1.0 / (sigma_metres * sigma_metres)),
                          Eigen::Vector3d::Constant(1.0 / (sigma_radians * sigma_radians)))
                             .finished()
                             .asDiagonal();
  const std::vector<Eigen::Vector3f> points = static_points(view, camera);
  const Eigen::Isometry3d T_view_predicted = T_view_world;
  Eigen::Isometry3d T_world_view = T_view_world.inverse();
  for (int iteration = 0; iteration < iterations; ++iteration) {
    Equations equations(field, points, T_world_view);
    if (equations.near < fewest_cells) return std::nullopt;
    equations.hessian += prior;
    equations.gradient += prior * geometry::log_se3(T_view_predicted * T_world_view);
    const Vector6d step = equations.hessian.ldlt().solve(-equations.gradient);
    if (!step.allFinite()) return std::nullopt;
    T_world_view = T_world_view * geometry::exp_se3(step);
    if (step.norm() < 1e-4) break;
  }
  const Equations last(field, points, T_world_view);
  if (last.on_surface < fewest_cells || last.on_surface < least_agreement * last.near) return std::nullopt;
  // Where the next pose is predicted from two such poses, rounding errors of the rotation grow by 2.4 from frame to
  // frame.
  return geometry::orthonormalised(T_world_view).inverse();
}

}  // namespace holdfast
