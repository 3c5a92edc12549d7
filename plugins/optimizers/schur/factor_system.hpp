// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "block_cholesky.hpp"
#include "block_system.hpp"
#include "holdfast/interfaces/bundle_factors.hpp"

namespace holdfast::schur_plugin {

/// The part of a bundle adjustment that its factors add to the reduced camera system. With p free poses, m free motions
/// and the world, the system after the elimination of the points is
///
///     [ S + F_pp   F_pm   F_pw ]  6 p
///     [   .        F_mm   F_mw ]  9 m
///     [   .          .    F_ww ]  up to 3
///
/// where S is the visual part (BlockSystem) and F the Gauss-Newton Hessian of the factors. Each pose, each motion and
/// the world is a block of BlockCholesky, since motions are coupled in chains.
class FactorSystem {
 public:
  /// Takes the factors of a problem; `free_poses` are the indices of the free poses in the order of the system.
  /// Returns whether the factors' numbers can be used.
  bool begin(const BundleProblem& problem, std::span<const std::uint32_t> free_poses);
  /// Releases the problem.
  void end() { evaluation_.reset(); }
  bool empty() const { return !evaluation_ || evaluation_->factors().empty(); }

  /// Cost of the factors, with the free poses T_camera_world (as in BundleArrays), at the current motions or at those
  /// after the step.
  double cost(const double* poses);
  double moved_cost(const double* poses);
  /// Makes the states after the step the current ones.
  void accept() {
    std::swap(states_, moved_states_);
    linearised_ = false;
  }

  /// Linearises the factors at the current states, unless they have not changed since.
  void linearise(const double* poses);
  /// Of a free pose, the diagonal of the factors' Hessian.
  double diagonal(std::size_t number) const { return diagonal_[static_cast<Eigen::Index>(number)]; }
  double gradient(std::size_t number) const { return gradient_[static_cast<Eigen::Index>(number)]; }
  /// Solves the system, of which `visual` is the part of the poses with their damping. In: the right-hand side of the
  /// poses; out: their steps. Sets the states after the step, and adds the decrease that the linearisation predicts of
  /// motions and world. False if there is no solution.
  bool solve(const BlockSystem& visual, double damping, Eigen::VectorXd& steps, double& predicted_decrease);
  /// Writes the current motions and world to the problem; false if they are not finite.
  bool write(BundleProblem& problem) const;

 private:
  /// Free states of a factor, and its Hessian by them.
  struct Term {
    struct Block {
      std::size_t number = 0;  // of the block in the system
      Eigen::Index begin = 0;  // of its columns in the Hessian
      Eigen::Index first = 0;  // its first number in the system
      Eigen::Index size = 0;
    };
    std::vector<Block> blocks;
    Eigen::MatrixXd hessian;
  };
  void take_poses(const double* poses, FactorEvaluation::States& states) const;
  Term term_of(const FactorEvaluation::Factor& factor) const;
  /// Derivatives of the residual by the free states of a factor.
  Eigen::MatrixXd derivative_of(const FactorEvaluation::Factor& factor, const FactorError& error) const;
  void analyse(const BlockSystem& visual);
  void fill(const BlockSystem& visual, const Eigen::VectorXd& extra);
  void move_states(const Eigen::VectorXd& steps);

  std::optional<FactorEvaluation> evaluation_;
  FactorEvaluation::States states_, moved_states_;
  std::vector<std::uint32_t> free_poses_;
  std::vector<int> block_of_pose_, block_of_motion_;  // -1 = fixed
  std::array<bool, 3> world_moves_{};
  std::vector<int> sizes_;                    // of blocks
  std::vector<Eigen::Index> first_of_block_;  // its first number
  Eigen::Index size_ = 0;
  std::vector<Term> terms_;  // by factor
  Eigen::VectorXd diagonal_, gradient_;
  BlockCholesky cholesky_;
  bool analyzed_ = false, linearised_ = false;
};

}  // namespace holdfast::schur_plugin
