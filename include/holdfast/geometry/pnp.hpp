// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "holdfast/interfaces/optimizer.hpp"

namespace holdfast::geometry {

/// The camera poses from which three world points are seen along three directions (camera frame, any length): none to
/// four. Grunert's solution of 1841, as given by Haralick, Lee, Ottenberg and Noelle, "Review and analysis of solutions
/// of the three point perspective pose estimation problem", IJCV 13(3), 1994, equations 9 and 10; the roots of the
/// quartic from its companion matrix.
std::vector<Eigen::Isometry3d> solve_p3p(const std::array<Eigen::Vector3d, 3>& points,
                                         const std::array<Eigen::Vector3d, 3>& directions);

/// How the samples of a pose without a first guess are drawn and judged.
struct PnpOptions {
  int iterations = 300;       ///< at most
  double confidence = 0.999;  ///< stop when a better sample is this unlikely
  int minimum_inliers = 10;
  std::uint64_t seed = 1;
};

/// A camera pose without a first guess: solve_p3p on samples of three, decided by the chi-square test of every
/// observation (Fischler and Bolles 1981), then adjust_pose from the best. problem.T_camera_world need not be set; it
/// and problem.inlier are results, as in adjust_pose. The same input and seed give the same result. Not usable, and the
/// pose unchanged, when fewer than minimum_inliers agree.
PoseSummary find_pose(PoseProblem& problem, const PnpOptions& options = {});

}  // namespace holdfast::geometry
