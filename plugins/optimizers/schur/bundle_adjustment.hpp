// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <vector>

#include "block_system.hpp"
#include "bundle_arrays.hpp"
#include "damping.hpp"
#include "factor_system.hpp"
#include "holdfast/interfaces/bundle_selection.hpp"
#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/settings/schur.hpp"
#include "kernels.hpp"

namespace holdfast::schur_plugin {

/// Bundle adjustment by Levenberg-Marquardt on the Schur complement: the points are eliminated one by one while the
/// observations are linearised, so that no Jacobian is stored (Triggs et al. 2000, section 6.1; Lourakis and Argyros
/// 2009). Runs on the calling thread and keeps its memory between problems; each thread needs one of its own.
///
/// A free pose moves by a left perturbation of T_camera_world (translation [m], rotation [rad]). Phase one has Huber's
/// cost; then observations beyond the chi-square limit are left out, and phase two has plain squares. At the end every
/// observation is decided anew: `outlier` is also set for points behind the camera and for numbers that are not finite.
/// If the problem states a tolerance, a phase ends when a step lowers the cost by less than this share. Otherwise it
/// ends when a step lowers the cost by less than function_tolerance of it (ten times as much in phase one, which
/// prepares phase two), or moves no free pose by more than step_tolerance, or when the actual decrease matches the
/// predicted one (gain ratio ~1) within the tolerance, so that another step would gain less.
///
/// Left as they are: points without an observation from a free pose, points with fewer than three residuals, poses
/// without observations and factors. Not usable: nothing free, or no finite solution. Indices out of range throw
/// CheckError. With no fixed pose at all the gauge is held only by the damping.
class BundleAdjuster {
 public:
  BundleAdjuster(const SchurSettings& settings, SimdLevel level) : settings_(settings), kernels_(kernels(level)) {}

  BundleSummary run(BundleProblem& problem, const std::atomic<bool>& stop);

 private:
  /// Takes the factors of the problem, if it has any; false if they cannot be used.
  bool take_factors(const BundleProblem& problem);
  void build_system();
  /// One phase of at most `iterations`; returns the cost at its end.
  double minimise(int iterations, bool is_robust, const std::atomic<bool>& stop, BundleSummary& summary);
  /// Steps for a damping; returns whether there are any. Fills the state after the step and the predicted decrease.
  bool find_step(const BundleView& view, double& predicted_decrease, double& pose_step);
  void add_camera_diagonal();
  void move_poses();
  BundleView view(bool is_robust) const;
  /// Cost of the observations and factors, at the current state or at that after the step.
  double current_cost(bool is_robust);
  double moved_cost(bool is_robust);
  /// The outlier flag of each entry at the current state, with plain squares.
  void find_outliers(const BundleProblem& problem);
  bool write(BundleProblem& problem, BundleSummary& summary);

  SchurSettings settings_;
  const Kernels& kernels_;
  BundleSelection selection_;
  BundleArrays arrays_;
  BlockSystem system_;
  FactorSystem factors_;
  Damping damping_;
  const Camera* camera_ = nullptr;
  double function_tolerance_ = 0.0, step_tolerance_ = 0.0;
  bool stops_early_ = true;
  std::vector<std::uint32_t> pair_block_;
  std::vector<double> cameras_, camera_damping_, couplings_, eliminations_, steps_;
  std::vector<Scratch> scratch_;
  std::vector<double> moved_poses_, moved_points_, chi_squares_;
  std::vector<std::uint8_t> outliers_;
  Eigen::VectorXd right_hand_side_;
};

}  // namespace holdfast::schur_plugin
