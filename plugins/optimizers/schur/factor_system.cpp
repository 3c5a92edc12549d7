// SPDX-License-Identifier: BSD-3-Clause
#include "factor_system.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "holdfast/interfaces/optimizer.hpp"
#include "kernels.hpp"

namespace holdfast::schur_plugin {

bool FactorSystem::begin(const BundleProblem& problem, std::span<const std::uint32_t> free_poses) {
  evaluation_.emplace(problem);
  if (!evaluation_->is_finite()) return false;
  states_ = moved_states_ = evaluation_->states();
  free_poses_.assign(free_poses.begin(), free_poses.end());
  column_of_pose_.assign(problem.poses.size(), -1);
  size_ = 0;
  const auto next = [this](int count) { return std::exchange(size_, size_ + count); };
  for (const std::uint32_t pose : free_poses_) column_of_pose_[pose] = next(6);
  column_of_motion_.assign(states_.motions.size(), -1);
  for (std::size_t i = 0; i < states_.motions.size(); ++i)
    if (evaluation_->motion_moves(i)) column_of_motion_[i] = next(9);
  const std::array<bool, 3> world_moves = evaluation_->world_moves();
  for (std::size_t i = 0; i < 3; ++i) column_of_world_[i] = world_moves[i] ? next(1) : -1;
  analyzed_ = false;
  return true;
}

void FactorSystem::take_poses(const double* poses, FactorEvaluation::States& states) const {
  for (std::size_t i = 0; i < free_poses_.size(); ++i)
    states.poses[free_poses_[i]].matrix().topRows<3>() =
        Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(poses + pose_size * i);
}

double FactorSystem::cost(const double* poses) {
  take_poses(poses, states_);
  return evaluation_->cost(states_);
}

double FactorSystem::moved_cost(const double* poses) {
  take_poses(poses, moved_states_);
  return evaluation_->cost(moved_states_);
}

FactorSystem::Columns FactorSystem::columns_of(const FactorEvaluation::Factor& factor, const FactorError& error) const {
  Columns result;
  const auto add = [&](int column, const auto& derivative) {
    if (column < 0) return;
    result.derivative.middleCols(result.count, derivative.cols()) = derivative;
    for (int k = 0; k < derivative.cols(); ++k) result.column[static_cast<std::size_t>(result.count++)] = column + k;
  };
  for (std::size_t i = 0; i < 2; ++i)
    if (factor.poses[i] != FactorEvaluation::none) add(column_of_pose_[factor.poses[i]], error.by_pose[i]);
  for (std::size_t i = 0; i < 2; ++i)
    if (factor.motions[i] != FactorEvaluation::none) add(column_of_motion_[factor.motions[i]], error.by_motion[i]);
  if (factor.has_world)
    for (std::size_t i = 0; i < 3; ++i) add(column_of_world_[i], error.by_world.col(static_cast<Eigen::Index>(i)));
  return result;
}

void FactorSystem::linearise(const double* poses) {
  take_poses(poses, states_);
  factor_entries_.clear();
  gradient_.setZero(size_);
  diagonal_.setZero(size_);
  FactorError error;
  for (const FactorEvaluation::Factor& factor : evaluation_->factors()) {
    evaluation_->evaluate(factor, states_, true, error);
    const Columns columns = columns_of(factor, error);
    const auto derivative = columns.derivative.topLeftCorner(factor.rows, columns.count);
    const Eigen::MatrixXd hessian = derivative.transpose() * derivative;
    const Eigen::VectorXd gradient = derivative.transpose() * error.residual.head(factor.rows);
    for (int a = 0; a < columns.count; ++a) {
      const int column = columns.column[static_cast<std::size_t>(a)];
      gradient_[column] += gradient[a];
      diagonal_[column] += hessian(a, a);
      for (int b = 0; b < columns.count; ++b) {
        const int row = columns.column[static_cast<std::size_t>(b)];
        if (row >= column) factor_entries_.emplace_back(row, column, hessian(b, a));
      }
    }
  }
}

bool FactorSystem::solve(BlockSystem& visual, double damping, Eigen::VectorXd& steps, double& predicted_decrease) {
  entries_ = factor_entries_;
  visual.for_each_block([this](std::size_t row, std::size_t column, const double* block) {
    for (std::size_t c = 0; c < 6; ++c)
      for (std::size_t r = row == column ? c : 0; r < 6; ++r)
        entries_.emplace_back(static_cast<int>(6 * row + r), static_cast<int>(6 * column + c), block[6 * c + r]);
  });
  const auto poses = static_cast<int>(6 * free_poses_.size());
  Eigen::VectorXd solution(size_), extra = Eigen::VectorXd::Zero(size_);
  for (int i = poses; i < size_; ++i) {
    extra[i] = damping * std::clamp(diagonal_[i], 1e-6, 1e32);
    entries_.emplace_back(i, i, extra[i]);
  }
  matrix_.resize(size_, size_);
  matrix_.setFromTriplets(entries_.begin(), entries_.end());
  if (!analyzed_) factorisation_.analyzePattern(matrix_);
  analyzed_ = true;
  factorisation_.factorize(matrix_);
  if (factorisation_.info() != Eigen::Success || !(factorisation_.vectorD().array() > 0.0).all()) return false;
  solution.head(poses) = steps;
  solution.tail(size_ - poses) = -gradient_.tail(size_ - poses);
  solution = factorisation_.solve(solution).eval();
  if (!solution.allFinite()) return false;
  for (int i = poses; i < size_; ++i)
    predicted_decrease += 0.5 * (extra[i] * solution[i] * solution[i] - gradient_[i] * solution[i]);
  steps = solution.head(poses);
  move_states(solution);
  return true;
}

void FactorSystem::move_states(const Eigen::VectorXd& steps) {
  for (std::size_t i = 0; i < states_.motions.size(); ++i)
    if (column_of_motion_[i] >= 0)
      moved_states_.motions[i] = states_.motions[i] + steps.segment<9>(column_of_motion_[i]);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    moved_states_.world[k] = states_.world[k] + (column_of_world_[i] >= 0 ? steps[column_of_world_[i]] : 0.0);
  }
}

bool FactorSystem::write(BundleProblem& problem) const {
  const auto is_finite = [](const auto& motion) { return motion.allFinite(); };
  if (!std::all_of(states_.motions.begin(), states_.motions.end(), is_finite) || !states_.world.allFinite())
    return false;
  evaluation_->write(states_, problem);
  return true;
}

}  // namespace holdfast::schur_plugin
