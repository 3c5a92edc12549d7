// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "holdfast/geometry/alignment.hpp"

namespace holdfast::geometry {

namespace detail {

/// Eigenvalues of the companion matrix of a quartic polynomial, from its real Schur form; the matrix is already upper
/// Hessenberg. False when the iteration does not converge.
inline bool companion_eigenvalues(const Eigen::Matrix4d& companion, Eigen::Vector4cd& values) {
  const double scale = companion.cwiseAbs().maxCoeff();
  const Eigen::Matrix4d scaled = companion / scale;
  Eigen::RealSchur<Eigen::Matrix4d> schur;
  schur.computeFromHessenberg(scaled, scaled, false);
  if (schur.info() != Eigen::Success) return false;
  const Eigen::Matrix4d T = schur.matrixT() * scale;
  for (int i = 0; i < 4; ++i) {
    if (i == 3 || T(i + 1, i) == 0.0) {
      values[i] = T(i, i);
      continue;
    }
    const double b = T(i, i + 1), c = T(i + 1, i), p = 0.5 * (T(i, i) - T(i + 1, i + 1));
    const double largest = std::max({std::abs(p), std::abs(b), std::abs(c)});  // against overflow of the squares
    const double imaginary =
        largest * std::sqrt(std::abs((p / largest) * (p / largest) + (c / largest) * (b / largest)));
    values[i] = {T(i + 1, i + 1) + p, imaginary};
    values[i + 1] = {T(i + 1, i + 1) + p, -imaginary};
    ++i;
  }
  return true;
}

/// Real roots of c[4] v^4 + ... + c[0], each polished by Newton's method.
inline std::vector<double> real_roots(const std::array<double, 5>& c) {
  std::vector<double> roots;
  if (!(std::abs(c[4]) > 1e-14)) return roots;
  Eigen::Matrix4d companion = Eigen::Matrix4d::Zero();
  for (int i = 0; i < 4; ++i) companion(i, 3) = -c[i] / c[4];
  for (int i = 1; i < 4; ++i) companion(i, i - 1) = 1.0;
  Eigen::Vector4cd values;
  if (!companion.allFinite() || !companion_eigenvalues(companion, values)) return roots;
  for (int i = 0; i < 4; ++i) {
    // Rounding turns a double root into a pair with a small imaginary part.
    if (std::abs(values[i].imag()) > 1e-4 * (1.0 + std::abs(values[i].real()))) continue;
    double v = values[i].real();
    for (int step = 0; step < 2; ++step) {
      const double value = c[0] + v * (c[1] + v * (c[2] + v * (c[3] + v * c[4])));
      const double slope = c[1] + v * (2 * c[2] + v * (3 * c[3] + v * 4 * c[4]));
      if (std::abs(slope) > 1e-12) v -= value / slope;
    }
    roots.push_back(v);
  }
  return roots;
}

}  // namespace detail

/// P3P: the up to four camera poses T_camera_world from which three world points are seen along three directions
/// (camera frame, any length). Grunert's solution of 1841, as given by Haralick, Lee, Ottenberg and Noelle, "Review and
/// analysis of solutions of the three point perspective pose estimation problem", IJCV 13(3), 1994, equations 9 and 10;
/// the roots of the quartic are the eigenvalues of its companion matrix.
inline std::vector<Eigen::Isometry3d> solve_p3p(const std::array<Eigen::Vector3d, 3>& points,
                                                const std::array<Eigen::Vector3d, 3>& directions) {
  std::vector<Eigen::Isometry3d> poses;
  std::array<Eigen::Vector3d, 3> unit;
  for (std::size_t i = 0; i < 3; ++i) unit[i] = directions[i].normalized();
  const double a2 = (points[1] - points[2]).squaredNorm();
  const double b2 = (points[0] - points[2]).squaredNorm();
  const double c2 = (points[0] - points[1]).squaredNorm();
  if (!(b2 > 0.0)) return poses;
  const double alpha = unit[1].dot(unit[2]), beta = unit[0].dot(unit[2]), gamma = unit[0].dot(unit[1]);

  // Distances s0, s1 = u s0, s2 = v s0 along the directions; eliminating u leaves a quartic in v.
  const double difference = (a2 - c2) / b2, sum = (a2 + c2) / b2, c = c2 / b2, a = a2 / b2;
  const std::array<double, 5> quartic = {
      (1 + difference) * (1 + difference) - 4 * a * gamma * gamma,
      4 * (-difference * (1 + difference) * beta + 2 * a * gamma * gamma * beta - (1 - sum) * alpha * gamma),
      2 * (difference * difference - 1 + 2 * difference * difference * beta * beta + 2 * (1 - c) * alpha * alpha -
           4 * sum * alpha * beta * gamma + 2 * (1 - a) * gamma * gamma),
      4 * (difference * (1 - difference) * beta - (1 - sum) * alpha * gamma + 2 * c * alpha * alpha * beta),
      (difference - 1) * (difference - 1) - 4 * c * alpha * alpha};
  for (const double v : detail::real_roots(quartic)) {
    const double denominator = 2 * (gamma - v * alpha);
    const double spread = 1 + v * v - 2 * v * beta;
    if (!(v > 0.0) || std::abs(denominator) < 1e-12 || !(spread > 0.0)) continue;
    const double u = ((difference - 1) * v * v - 2 * difference * beta * v + 1 + difference) / denominator;
    if (!(u > 0.0)) continue;
    const double distance = std::sqrt(b2 / spread);
    const std::array<Eigen::Vector3d, 3> seen = {distance * unit[0], u * distance * unit[1], v * distance * unit[2]};
    if (const auto pose = align_points(points, seen)) poses.push_back(pose->motion());
  }
  return poses;
}

}  // namespace holdfast::geometry
