// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "holdfast/geometry/pinhole.hpp"

/// Pose of one camera from 2D-3D correspondences (PnP, motion-only adjustment): the problem, its solvers' settings and
/// their result. The solvers are templates over the caller's own type of problem, which PoseProblemTraits describes;
/// they are declared here, so that a library can instantiate them once, and defined in pose_adjustment.hpp and pnp.hpp.
namespace holdfast::geometry {

/// Chi-square limits at 95 % for observations with two (x, y) and three (x, y, right_x) residuals.
inline constexpr double chi_square_two = 5.991;
inline constexpr double chi_square_three = 7.815;

/// Disparity noise of a structured-light sensor such as the Kinect, for the equivalent stereo pair: constant over depth
/// and independent of the pixel noise (Khoshelham and Elberink 2012, equation 13, including errors correlated between
/// neighbouring pixels). Its cost is linear (Huber) beyond `disparity_threshold` standard deviations, because a wrong
/// depth does not make the pixel an outlier.
inline constexpr double disparity_sigma = 0.7;  ///< [px]
inline constexpr double disparity_threshold = 1.5;

/// Minimum depth of an inlier in the camera frame [m].
inline constexpr double minimum_depth = 1e-3;

/// Access of the solvers to a caller's problem. Specialise it; all members are static functions:
///
///   Pinhole pinhole(const Problem&)                        the camera
///   std::size_t size(const Problem&)                       number of observations
///   Eigen::Vector3d point(const Problem&, std::size_t i)   point that observation i shows, in the world frame [m]
///   Eigen::Vector2d pixel(const Problem&, std::size_t i)   where it was observed [px], without lens distortion
///   Eigen::Isometry3d pose(const Problem&)                 T_camera_world, the first guess
///   void set_pose(Problem&, const Eigen::Isometry3d&)      receives the result
///   void set_inlier(Problem&, std::size_t i, bool)         receives whether observation i is an inlier
///
/// and, where the default does not serve:
///
///   double right_x(const Problem&, std::size_t i)      column in the right image [px]; NaN = none, the default
///   double information(const Problem&, std::size_t i)  inverse variance of a pixel coordinate [1/px^2]; default 1
///   double weight(const Problem&, std::size_t i)       factor of the observation's cost, 0 to 1; default 1
///   void begin(Problem&)                               called before all others: may check the problem and make room
///                                                      for the inliers
template <class Problem>
struct PoseProblemTraits;

/// Type whose PoseProblemTraits has all required members.
template <class Problem>
concept PoseProblemType = requires(Problem& problem, const Problem& constant, const Eigen::Isometry3d& pose) {
  { PoseProblemTraits<Problem>::pinhole(constant) } -> std::convertible_to<Pinhole>;
  { PoseProblemTraits<Problem>::size(constant) } -> std::convertible_to<std::size_t>;
  { PoseProblemTraits<Problem>::point(constant, std::size_t{}) } -> std::convertible_to<Eigen::Vector3d>;
  { PoseProblemTraits<Problem>::pixel(constant, std::size_t{}) } -> std::convertible_to<Eigen::Vector2d>;
  { PoseProblemTraits<Problem>::pose(constant) } -> std::convertible_to<Eigen::Isometry3d>;
  PoseProblemTraits<Problem>::set_pose(problem, pose);
  PoseProblemTraits<Problem>::set_inlier(problem, std::size_t{}, true);
};

/// The result of a solver for the pose of one camera.
struct PoseSummary {
  bool usable = false;  ///< false: too few observations or no finite solution; T_camera_world is unchanged then
  int inliers = 0;
  int iterations = 0;
  double final_cost = 0.0;
  /// Inverse of the approximated Hessian at the result: covariance of a left perturbation (translation, rotation).
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

/// Rounds and limits of adjust_pose().
struct PoseAdjustmentOptions {
  int robust_rounds = 2;                    ///< with Huber's cost
  int final_rounds = 2;                     ///< without it
  bool trust_guess = false;                 ///< outliers at the initial guess are already excluded from the first round
  int iterations = 10;                      ///< at most, per round
  double chi_square_2d = chi_square_two;    ///< an observation with two residuals beyond this is an outlier
  double chi_square_3d = chi_square_three;  ///< an observation with three residuals beyond this is an outlier
  double disparity_sigma = geometry::disparity_sigma;          ///< standard deviation of x - right_x [px]
  double disparity_threshold = geometry::disparity_threshold;  ///< of Huber's cost of x - right_x [deviations]
};

/// Sampling and stopping rules of find_pose().
struct PnpOptions {
  int iterations = 300;       ///< at most
  double confidence = 0.999;  ///< sampling stops when the probability of a better sample is below 1 - confidence
  int minimum_inliers = 10;
  std::uint64_t seed = 1;
};

/// Motion-only bundle adjustment (Mur-Artal and Tardos 2017, equation 3): the pose of one camera against fixed points
/// by Levenberg-Marquardt on a left perturbation of T_camera_world. The residuals are the pixel's, weighted by its
/// information, and that of the disparity x - right_x, with separate noise.
///
/// After each round every observation is tested anew: it is an outlier if its squared residual times its information
/// (x, y and right_x) exceeds the chi-square limit, or if its point lies behind the camera. Outliers do not count in
/// the next round. Huber's threshold is the square root of the limit. The weight scales an observation's cost but not
/// its chi-square test; weight 0 excludes it from the pose and from the count of inliers, while set_inlier still tells
/// whether it fits. An observation with a number that is not finite is never an inlier.
///
/// The result is not usable, the pose unchanged and no observation an inlier, if fewer than three observations count,
/// if the points do not determine the pose, or if fewer than three inliers remain.
///
/// The result has the same bits on every processor if floating-point contraction is off (-ffp-contract=off).
/// -fno-math-errno makes it faster and keeps the bits. Thread-safe; scratch memory is kept per thread, so that memory
/// is allocated only when a problem is larger than all before it.
template <PoseProblemType Problem>
PoseSummary adjust_pose(Problem& problem, const PoseAdjustmentOptions& options = {});

/// PnP by RANSAC (Fischler and Bolles 1981), without an initial guess: solve_p3p on random samples of three, evaluated
/// by the chi-square test of every observation, then adjust_pose from the best sample. The first guess in the problem
/// is ignored. The same input and seed give the same result. The result is not usable, and the pose unchanged, if fewer
/// than minimum_inliers agree.
template <PoseProblemType Problem>
PoseSummary find_pose(Problem& problem, const PnpOptions& options = {});

namespace detail {

template <class Problem>
double right_x(const Problem& problem, std::size_t i) {
  if constexpr (requires { PoseProblemTraits<Problem>::right_x(problem, i); })
    return PoseProblemTraits<Problem>::right_x(problem, i);
  else
    return std::numeric_limits<double>::quiet_NaN();
}

template <class Problem>
double information(const Problem& problem, std::size_t i) {
  if constexpr (requires { PoseProblemTraits<Problem>::information(problem, i); })
    return PoseProblemTraits<Problem>::information(problem, i);
  else
    return 1.0;
}

template <class Problem>
double weight(const Problem& problem, std::size_t i) {
  if constexpr (requires { PoseProblemTraits<Problem>::weight(problem, i); })
    return PoseProblemTraits<Problem>::weight(problem, i);
  else
    return 1.0;
}

/// Lets the traits prepare the problem, and marks all observations as outliers.
template <class Problem>
void begin(Problem& problem) {
  using Traits = PoseProblemTraits<Problem>;
  if constexpr (requires { Traits::begin(problem); }) Traits::begin(problem);
  const std::size_t size = Traits::size(problem);
  for (std::size_t i = 0; i < size; ++i) Traits::set_inlier(problem, i, false);
}

}  // namespace detail

}  // namespace holdfast::geometry
