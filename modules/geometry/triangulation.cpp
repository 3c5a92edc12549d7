// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/geometry/triangulation.hpp"

#include <Eigen/SVD>

#include "holdfast/geometry/pose_adjustment.hpp"

namespace holdfast::geometry {

std::optional<Eigen::Vector3d> triangulate_linear(const Eigen::Isometry3d& T_a_world, const Eigen::Vector3d& ray_a,
                                                  const Eigen::Isometry3d& T_b_world, const Eigen::Vector3d& ray_b) {
  const Eigen::Matrix<double, 3, 4> a = T_a_world.matrix().topRows<3>();
  const Eigen::Matrix<double, 3, 4> b = T_b_world.matrix().topRows<3>();
  Eigen::Matrix4d system;
  system.row(0) = ray_a.x() * a.row(2) - ray_a.z() * a.row(0);
  system.row(1) = ray_a.y() * a.row(2) - ray_a.z() * a.row(1);
  system.row(2) = ray_b.x() * b.row(2) - ray_b.z() * b.row(0);
  system.row(3) = ray_b.y() * b.row(2) - ray_b.z() * b.row(1);
  if (!system.allFinite()) return std::nullopt;
  const Eigen::JacobiSVD<Eigen::Matrix4d> svd(system, Eigen::ComputeFullV);
  const Eigen::Vector4d solution = svd.matrixV().col(3);
  if (std::abs(solution.w()) < 1e-12) return std::nullopt;
  return solution.head<3>() / solution.w();
}

TriangulatedPoint triangulate(const Camera& camera, const Eigen::Isometry3d& T_a_world, const Eigen::Vector2d& pixel_a,
                              double sigma2_a, const Eigen::Isometry3d& T_b_world, const Eigen::Vector2d& pixel_b,
                              double sigma2_b, const TriangulationOptions& options) {
  TriangulatedPoint result;
  const Eigen::Vector3d ray_a = camera.back_project(pixel_a.x(), pixel_a.y(), 1.0);
  const Eigen::Vector3d ray_b = camera.back_project(pixel_b.x(), pixel_b.y(), 1.0);
  const Eigen::Vector3d world_a = T_a_world.linear().transpose() * ray_a;
  const Eigen::Vector3d world_b = T_b_world.linear().transpose() * ray_b;
  result.parallax_cosine = world_a.dot(world_b) / (world_a.norm() * world_b.norm());
  if (!(result.parallax_cosine < options.largest_parallax_cosine)) return result;
  const auto point = triangulate_linear(T_a_world, ray_a, T_b_world, ray_b);
  if (!point) return result;

  const Eigen::Vector3d in_a = T_a_world * *point, in_b = T_b_world * *point;
  if (!(in_a.z() > minimum_depth && in_b.z() > minimum_depth)) {
    result.status = TriangulationStatus::behind_camera;
    return result;
  }
  const double error_a = (camera.project(in_a) - pixel_a).squaredNorm() / sigma2_a;
  const double error_b = (camera.project(in_b) - pixel_b).squaredNorm() / sigma2_b;
  const bool fits = error_a <= options.limit && error_b <= options.limit;
  result.status = fits ? TriangulationStatus::good : TriangulationStatus::large_error;
  result.point = *point;
  return result;
}

}  // namespace holdfast::geometry
