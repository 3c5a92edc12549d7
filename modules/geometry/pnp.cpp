// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/geometry/pnp.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "holdfast/core/error.hpp"
#include "holdfast/geometry/alignment.hpp"
#include "holdfast/geometry/pose_adjustment.hpp"
#include "holdfast/geometry/ransac.hpp"
#include "pose_system.hpp"

namespace holdfast::geometry {
namespace {

/// Real roots of c[4] v^4 + ... + c[0], each polished by Newton's method.
std::vector<double> real_roots(const std::array<double, 5>& c) {
  std::vector<double> roots;
  if (!(std::abs(c[4]) > 1e-14)) return roots;
  Eigen::Matrix4d companion = Eigen::Matrix4d::Zero();
  for (int i = 0; i < 4; ++i) companion(i, 3) = -c[i] / c[4];
  for (int i = 1; i < 4; ++i) companion(i, i - 1) = 1.0;
  if (!companion.allFinite()) return roots;
  const Eigen::Vector4cd values = Eigen::EigenSolver<Eigen::Matrix4d>(companion, false).eigenvalues();
  for (int i = 0; i < 4; ++i) {
    // A double root comes out as a pair with a small imaginary part.
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

/// How many usable observations pass the chi-square test.
int count_inliers(const PoseProblem& problem, const std::vector<std::uint32_t>& usable,
                  const Eigen::Isometry3d& T_camera_world) {
  const Camera& camera = *problem.camera;
  int count = 0;
  for (const std::uint32_t i : usable) {
    const Eigen::Vector3d p = T_camera_world * problem.points[i];
    if (!(p.z() > minimum_depth)) continue;
    const Eigen::Vector2d pixel = camera.project(p);
    double squared = (pixel - Eigen::Vector2d(problem.x[i], problem.y[i])).squaredNorm();
    double limit = chi_square_two;
    if (!std::isnan(problem.right_x[i])) {
      const double right = camera.right_x(pixel.x(), p.z()) - problem.right_x[i];
      squared += right * right;
      limit = chi_square_three;
    }
    count += squared * problem.inverse_sigma2[i] <= limit;
  }
  return count;
}

}  // namespace

std::vector<Eigen::Isometry3d> solve_p3p(const std::array<Eigen::Vector3d, 3>& points,
                                         const std::array<Eigen::Vector3d, 3>& directions) {
  std::vector<Eigen::Isometry3d> poses;
  std::array<Eigen::Vector3d, 3> unit;
  for (int i = 0; i < 3; ++i) unit[i] = directions[i].normalized();
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
  for (const double v : real_roots(quartic)) {
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

PoseSummary find_pose(PoseProblem& problem, const PnpOptions& options) {
  const std::size_t size = problem.size();
  check_pose_problem(problem);
  problem.inlier.assign(size, 0);
  std::vector<std::uint32_t> usable;
  for (std::size_t i = 0; i < size; ++i)
    if (problem.weight[i] > 0.0f && problem.points[i].allFinite() && std::isfinite(problem.x[i]) &&
        std::isfinite(problem.y[i]))
      usable.push_back(static_cast<std::uint32_t>(i));
  const int needed = std::max(4, options.minimum_inliers);
  if (static_cast<int>(usable.size()) < needed) return {};

  Random random(options.seed);
  Eigen::Isometry3d best = Eigen::Isometry3d::Identity();
  int best_inliers = 0;
  int iterations = options.iterations;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    const auto sample = sample_without_repeat<3>(random, static_cast<std::uint32_t>(usable.size()));
    std::array<Eigen::Vector3d, 3> points, directions;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t i = usable[sample[k]];
      points[k] = problem.points[i];
      directions[k] = problem.camera->back_project(problem.x[i], problem.y[i], 1.0);
    }
    for (const Eigen::Isometry3d& pose : solve_p3p(points, directions)) {
      const int inliers = count_inliers(problem, usable, pose);
      if (inliers <= best_inliers) continue;
      best = pose, best_inliers = inliers;
      iterations = ransac_iterations(static_cast<double>(inliers) / static_cast<double>(usable.size()), 3,
                                     options.confidence, options.iterations);
    }
  }
  // A sample of noisy pixels is rough; fewer agree with it than with the adjusted pose.
  if (best_inliers < std::max(4, needed / 2)) return {};
  const Eigen::Isometry3d before = problem.T_camera_world;
  problem.T_camera_world = best;
  PoseAdjustmentOptions adjustment;
  adjustment.trust_guess = true;
  const PoseSummary summary = adjust_pose(problem, adjustment);
  if (summary.usable && summary.inliers >= needed) return summary;
  problem.T_camera_world = before;
  problem.inlier.assign(size, 0);
  return {};
}

}  // namespace holdfast::geometry
