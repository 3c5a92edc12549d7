// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>
#include <optional>

#include "holdfast/geometry/pinhole.hpp"
#include "holdfast/geometry/pose_problem.hpp"

namespace holdfast::geometry {

/// Midpoint method (Hartley and Sturm 1997, section 5.3): the midpoint of the shortest connection of two rays. Rays
/// start at the camera centres [m, world]; directions need not be of unit length. Empty for parallel rays.
inline std::optional<Eigen::Vector3d> triangulate_midpoint(const Eigen::Vector3d& centre_a,
                                                           const Eigen::Vector3d& direction_a,
                                                           const Eigen::Vector3d& centre_b,
                                                           const Eigen::Vector3d& direction_b) {
  const Eigen::Vector3d offset = centre_b - centre_a;
  const double aa = direction_a.squaredNorm(), bb = direction_b.squaredNorm(), ab = direction_a.dot(direction_b);
  const double determinant = aa * bb - ab * ab;
  if (!(determinant > 1e-14 * aa * bb)) return std::nullopt;
  const double a = direction_a.dot(offset), b = direction_b.dot(offset);
  const double along_a = (a * bb - b * ab) / determinant;
  const double along_b = (a * ab - b * aa) / determinant;
  return 0.5 * (centre_a + along_a * direction_a + centre_b + along_b * direction_b);
}

/// Linear triangulation (Hartley and Sturm 1997, section 5.1, homogeneous): algebraic least squares of the four
/// projection equations of two views. `ray_a`, `ray_b`: (x, y, 1) in the camera frames. Empty for a point at infinity.
inline std::optional<Eigen::Vector3d> triangulate_linear(const Eigen::Isometry3d& T_a_world,
                                                         const Eigen::Vector3d& ray_a,
                                                         const Eigen::Isometry3d& T_b_world,
                                                         const Eigen::Vector3d& ray_b) {
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

/// Conditions of triangulate().
struct TriangulationOptions {
  double max_parallax_cosine = 0.9998;  ///< 0.9998 is 1.15 degrees
  double limit = 5.991;                 ///< chi-square of the reprojection in each view
};

/// Status of a triangulated point.
enum class TriangulationStatus { good, little_parallax, behind_camera, large_error };

/// A triangulated point and its status.
struct TriangulatedPoint {
  TriangulationStatus status = TriangulationStatus::little_parallax;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< world [m]; valid only with status good
  double parallax_cosine = 1.0;                     ///< of the angle between the two rays
};

/// Observation of a point by one camera.
struct PointView {
  Eigen::Isometry3d T_camera_world;
  Eigen::Vector2d pixel;  ///< without lens distortion [px]
  double sigma2 = 1.0;    ///< variance of a pixel coordinate [px^2]
};

/// Triangulation of a map point from two views of the same camera, with checks of parallax, positive depth and
/// reprojection error (chi-square) in both views (Mur-Artal et al. 2015, section VI-D). Any camera type with
/// CameraTraits.
template <class Camera>
TriangulatedPoint triangulate(const Camera& camera_model, const PointView& a, const PointView& b,
                              const TriangulationOptions& options = {}) {
  const Pinhole camera = pinhole_of(camera_model);
  TriangulatedPoint result;
  const Eigen::Vector3d ray_a = camera.back_project(a.pixel.x(), a.pixel.y(), 1.0);
  const Eigen::Vector3d ray_b = camera.back_project(b.pixel.x(), b.pixel.y(), 1.0);
  const Eigen::Vector3d world_a = a.T_camera_world.linear().transpose() * ray_a;
  const Eigen::Vector3d world_b = b.T_camera_world.linear().transpose() * ray_b;
  result.parallax_cosine = world_a.dot(world_b) / (world_a.norm() * world_b.norm());
  if (!(result.parallax_cosine < options.max_parallax_cosine)) return result;
  const auto point = triangulate_linear(a.T_camera_world, ray_a, b.T_camera_world, ray_b);
  if (!point) return result;

  const Eigen::Vector3d in_a = a.T_camera_world * *point, in_b = b.T_camera_world * *point;
  if (!(in_a.z() > minimum_depth && in_b.z() > minimum_depth)) {
    result.status = TriangulationStatus::behind_camera;
    return result;
  }
  const double error_a = (camera.project(in_a) - a.pixel).squaredNorm() / a.sigma2;
  const double error_b = (camera.project(in_b) - b.pixel).squaredNorm() / b.sigma2;
  const bool fits = error_a <= options.limit && error_b <= options.limit;
  result.status = fits ? TriangulationStatus::good : TriangulationStatus::large_error;
  result.point = *point;
  return result;
}

}  // namespace holdfast::geometry
