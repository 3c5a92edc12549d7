// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>

#include "holdfast/core/check.hpp"

/// Fundamental matrix and homography of two views from matched pixels (Hartley and Zisserman, Multiple View Geometry,
/// 2004).
namespace holdfast::geometry {

namespace detail {

/// Isotropic normalisation (section 4.4.4): the transformation to mean 0 and mean distance sqrt(2) of the pixels. Empty
/// for pixels that coincide or are not finite.
inline std::optional<Eigen::Matrix3d> normalising_transform(std::span<const Eigen::Vector2d> pixels) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& pixel : pixels) mean += pixel;
  mean /= static_cast<double>(pixels.size());
  double distance = 0.0;
  for (const Eigen::Vector2d& pixel : pixels) distance += (pixel - mean).norm();
  distance /= static_cast<double>(pixels.size());
  if (!(distance > 1e-9) || !std::isfinite(distance)) return std::nullopt;
  const double scale = std::sqrt(2.0) / distance;
  Eigen::Matrix3d transform;
  transform << scale, 0, -scale * mean.x(), 0, scale, -scale * mean.y(), 0, 0, 1;
  return transform;
}

/// Homogeneous least squares: the unit eigenvector of the smallest eigenvalue of `normal` (A^T A), as a row-major
/// matrix.
inline Eigen::Matrix3d least_squares_matrix(const Eigen::Matrix<double, 9, 9>& normal) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> solver(normal);
  const Eigen::Matrix<double, 9, 1> solution = solver.eigenvectors().col(0);
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(solution.data());
}

/// Estimates a 3x3 matrix by a normalised linear algorithm. `add_equations(p, q, normal)` adds the equations of a pair
/// of normalised homogeneous pixels, p of a and q of b, to A^T A; `denormalise(matrix, from_a, from_b)` undoes the
/// normalisation.
template <class AddEquations, class Denormalise>
std::optional<Eigen::Matrix3d> estimate_normalised(std::span<const Eigen::Vector2d> a,
                                                   std::span<const Eigen::Vector2d> b, std::size_t minimum,
                                                   AddEquations&& add_equations, Denormalise&& denormalise) {
  HOLDFAST_CHECK(a.size() == b.size(), "a " << a.size() << " b " << b.size());
  if (a.size() < minimum) return std::nullopt;
  const auto from_a = normalising_transform(a), from_b = normalising_transform(b);
  if (!from_a || !from_b) return std::nullopt;
  Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
  for (std::size_t i = 0; i < a.size(); ++i)
    add_equations(Eigen::Vector3d(*from_a * a[i].homogeneous()), Eigen::Vector3d(*from_b * b[i].homogeneous()), normal);
  return denormalise(least_squares_matrix(normal), *from_a, *from_b);
}

}  // namespace detail

/// The fundamental matrix, pixel_b^T * F * pixel_a = 0, of at least eight matched pixels by the normalised eight-point
/// algorithm (algorithm 11.1). Empty for fewer or coinciding pixels; different sizes throw CheckError.
inline std::optional<Eigen::Matrix3d> estimate_fundamental(std::span<const Eigen::Vector2d> a,
                                                           std::span<const Eigen::Vector2d> b) {
  return detail::estimate_normalised(
      a, b, 8,
      [](const Eigen::Vector3d& p, const Eigen::Vector3d& q, Eigen::Matrix<double, 9, 9>& normal) {
        Eigen::Matrix<double, 9, 1> row;
        row << q.x() * p, q.y() * p, p;
        normal += row * row.transpose();
      },
      [](const Eigen::Matrix3d& matrix, const Eigen::Matrix3d& from_a, const Eigen::Matrix3d& from_b) {
        const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
        Eigen::Vector3d singular = svd.singularValues();
        singular[2] = 0.0;
        const Eigen::Matrix3d rank_two = svd.matrixU() * singular.asDiagonal() * svd.matrixV().transpose();
        return Eigen::Matrix3d(from_b.transpose() * rank_two * from_a);
      });
}

/// The homography, pixel_b ~ H * pixel_a, of at least four matched pixels by the normalised direct linear transform
/// (algorithm 4.2). Empty for fewer or coinciding pixels; different sizes throw CheckError.
inline std::optional<Eigen::Matrix3d> estimate_homography(std::span<const Eigen::Vector2d> a,
                                                          std::span<const Eigen::Vector2d> b) {
  return detail::estimate_normalised(
      a, b, 4,
      [](const Eigen::Vector3d& p, const Eigen::Vector3d& q, Eigen::Matrix<double, 9, 9>& normal) {
        Eigen::Matrix<double, 9, 1> row;
        row << Eigen::Vector3d::Zero(), -p, q.y() * p;
        normal += row * row.transpose();
        row << p, Eigen::Vector3d::Zero(), -q.x() * p;
        normal += row * row.transpose();
      },
      [](const Eigen::Matrix3d& matrix, const Eigen::Matrix3d& from_a, const Eigen::Matrix3d& from_b) {
        return Eigen::Matrix3d(from_b.inverse() * matrix * from_a);
      });
}

/// The four motions T_b_a with unit translation that are consistent with an essential matrix (result 9.19).
inline std::array<Eigen::Isometry3d, 4> decompose_essential(const Eigen::Matrix3d& essential) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(essential, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d quarter_turn;
  quarter_turn << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  const Eigen::Vector3d translation = svd.matrixU().col(2);
  std::array<Eigen::Isometry3d, 4> motions;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Matrix3d turn = i < 2 ? quarter_turn : quarter_turn.transpose();
    Eigen::Matrix3d rotation = svd.matrixU() * turn * svd.matrixV().transpose();
    if (rotation.determinant() < 0.0) rotation = -rotation;
    Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
    motion.linear() = rotation;
    motion.translation() = i % 2 == 0 ? translation : Eigen::Vector3d(-translation);
    motions[static_cast<std::size_t>(i)] = motion;
  }
  return motions;
}

/// The four motions T_b_a with unit translation that are consistent with a plane-induced homography of rays (x, y, 1)
/// (Ma, Soatto, Kosecka and Sastry, An Invitation to 3-D Vision, 2004, section 5.3.3). Empty for a pure rotation, which
/// has no translation.
inline std::optional<std::array<Eigen::Isometry3d, 4>> decompose_homography(Eigen::Matrix3d homography) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> scale(homography);
  if (!(scale.singularValues()[2] > 0.0) || !homography.allFinite()) return std::nullopt;
  homography /= scale.singularValues()[1];
  if (homography.determinant() < 0.0) homography = -homography;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(homography, Eigen::ComputeFullV);
  const Eigen::Vector3d squared = svd.singularValues().cwiseAbs2();
  if (!(squared[0] - squared[2] > 1e-8)) return std::nullopt;
  Eigen::Matrix3d v = svd.matrixV();
  if (v.determinant() < 0.0) v = -v;
  const double s1 = std::sqrt(std::max(0.0, 1.0 - squared[2])), s3 = std::sqrt(std::max(0.0, squared[0] - 1.0));
  const double norm = std::sqrt(squared[0] - squared[2]);
  std::array<Eigen::Isometry3d, 4> motions;
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector3d u = (s1 * v.col(0) + (i == 0 ? s3 : -s3) * v.col(2)) / norm;
    Eigen::Matrix3d from, to;
    from << v.col(1), u, v.col(1).cross(u);
    const Eigen::Vector3d second = homography * v.col(1), third = homography * u;
    to << second, third, second.cross(third);
    Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
    motion.linear() = to * from.transpose();
    const Eigen::Vector3d normal = v.col(1).cross(u);
    const Eigen::Vector3d translation = (homography - motion.linear()) * normal;
    const double length = translation.norm();
    if (!(length > 1e-12)) return std::nullopt;
    for (const double sign : {1.0, -1.0}) {
      motion.translation() = sign / length * translation;
      motions[static_cast<std::size_t>(2 * i + (sign < 0.0))] = motion;
    }
  }
  return motions;
}

}  // namespace holdfast::geometry
