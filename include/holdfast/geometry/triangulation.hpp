// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "holdfast/core/camera.hpp"

namespace holdfast::geometry {

/// The point nearest to two rays in the least-squares sense: the middle of their shortest connection (Hartley and Sturm
/// 1997, section 5.3). Rays start at the camera centres [m, world], directions need not be of unit length. Nothing for
/// parallel rays.
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

/// The point that solves the four projection equations of two views in the algebraic least-squares sense (Hartley and
/// Sturm 1997, section 5.1, homogeneous). `ray_a`, `ray_b`: (x, y, 1) in the camera frames. Nothing for a point at
/// infinity.
std::optional<Eigen::Vector3d> triangulate_linear(const Eigen::Isometry3d& T_a_world, const Eigen::Vector3d& ray_a,
                                                  const Eigen::Isometry3d& T_b_world, const Eigen::Vector3d& ray_b);

/// What triangulate() asks of a point.
struct TriangulationOptions {
  double largest_parallax_cosine = 0.9998;  ///< 0.9998 is 1.15 degrees
  double limit = 5.991;                     ///< chi-square of the reprojection in each view
};

/// Whether a triangulated point is good, or what is wrong with it.
enum class TriangulationStatus { good, little_parallax, behind_camera, large_error };

/// A point that two views gave, and whether it is to be believed.
struct TriangulatedPoint {
  TriangulationStatus status = TriangulationStatus::little_parallax;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< world [m]; valid only with status good
  double parallax_cosine = 1.0;                     ///< of the angle between the two rays
};

/// A map point from two undistorted pixels, checked: enough parallax, in front of both cameras, and reprojected within
/// the chi-square limit in both (Mur-Artal et al. 2015, section VI-D). `sigma2`: variance of a pixel coordinate [px^2].
TriangulatedPoint triangulate(const Camera& camera, const Eigen::Isometry3d& T_a_world, const Eigen::Vector2d& pixel_a,
                              double sigma2_a, const Eigen::Isometry3d& T_b_world, const Eigen::Vector2d& pixel_b,
                              double sigma2_b, const TriangulationOptions& options = {});

}  // namespace holdfast::geometry
