// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "holdfast/core/random.hpp"
#include "holdfast/geometry/p3p.hpp"
#include "holdfast/geometry/pose_adjustment.hpp"
#include "holdfast/geometry/pose_problem.hpp"
#include "holdfast/geometry/ransac.hpp"

/// Definition of find_pose(), whose contract is in pose_problem.hpp.
namespace holdfast::geometry {

namespace detail {

/// Observations that samples are drawn from: finite, with non-zero weight.
template <class Problem>
std::vector<std::uint32_t> usable_observations(const Problem& problem) {
  using Traits = PoseProblemTraits<Problem>;
  std::vector<std::uint32_t> usable;
  const std::size_t size = Traits::size(problem);
  for (std::size_t i = 0; i < size; ++i)
    if (weight(problem, i) > 0.0 && Traits::point(problem, i).allFinite() && Traits::pixel(problem, i).allFinite())
      usable.push_back(static_cast<std::uint32_t>(i));
  return usable;
}

/// The number of usable observations that pass the chi-square test.
template <class Problem>
int count_inliers(const Problem& problem, const Pinhole& camera, const std::vector<std::uint32_t>& usable,
                  const Eigen::Isometry3d& T_camera_world) {
  using Traits = PoseProblemTraits<Problem>;
  int count = 0;
  for (const std::uint32_t i : usable) {
    const Eigen::Vector3d p = T_camera_world * Traits::point(problem, i);
    if (!(p.z() > minimum_depth)) continue;
    const Eigen::Vector2d pixel = camera.project(p);
    double squared = (pixel - Traits::pixel(problem, i)).squaredNorm();
    double limit = chi_square_two;
    if (const double observed = right_x(problem, i); !std::isnan(observed)) {
      const double right = camera.right_x(pixel.x(), p.z()) - observed;
      squared += right * right;
      limit = chi_square_three;
    }
    count += squared * information(problem, i) <= limit;
  }
  return count;
}

}  // namespace detail

template <PoseProblemType Problem>
PoseSummary find_pose(Problem& problem, const PnpOptions& options) {
  using Traits = PoseProblemTraits<Problem>;
  detail::begin(problem);
  const std::vector<std::uint32_t> usable = detail::usable_observations(problem);
  const int needed = std::max(4, options.minimum_inliers);
  if (static_cast<int>(usable.size()) < needed) return {};

  const Pinhole camera = Traits::pinhole(problem);
  Random random(options.seed);
  Eigen::Isometry3d best = Eigen::Isometry3d::Identity();
  int best_inliers = 0;
  int iterations = options.iterations;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    const auto sample = sample_without_repeat<3>(random, static_cast<std::uint32_t>(usable.size()));
    std::array<Eigen::Vector3d, 3> points, directions;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t i = usable[sample[k]];
      const Eigen::Vector2d pixel = Traits::pixel(problem, i);
      points[k] = Traits::point(problem, i);
      directions[k] = camera.back_project(pixel.x(), pixel.y(), 1.0);
    }
    for (const Eigen::Isometry3d& pose : solve_p3p(points, directions)) {
      const int inliers = detail::count_inliers(problem, camera, usable, pose);
      if (inliers <= best_inliers) continue;
      best = pose, best_inliers = inliers;
      iterations = ransac_iterations(static_cast<double>(inliers) / static_cast<double>(usable.size()), 3,
                                     options.confidence, options.iterations);
    }
  }
  // A pose from a minimal sample is imprecise: it has fewer inliers than the adjusted pose.
  if (best_inliers < std::max(4, needed / 2)) return {};
  const Eigen::Isometry3d before = Traits::pose(problem);
  Traits::set_pose(problem, best);
  PoseAdjustmentOptions adjustment;
  adjustment.trust_guess = true;
  const PoseSummary summary = adjust_pose(problem, adjustment);
  if (summary.usable && summary.inliers >= needed) return summary;
  Traits::set_pose(problem, before);
  detail::begin(problem);
  return {};
}

}  // namespace holdfast::geometry
