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
  sizes_.clear(), first_of_block_.clear();
  size_ = 0;
  const auto next = [this](int size) {
    first_of_block_.push_back(std::exchange(size_, size_ + size));
    sizes_.push_back(size);
    return static_cast<int>(sizes_.size()) - 1;
  };
  block_of_pose_.assign(problem.poses.size(), -1);
  for (const std::uint32_t pose : free_poses_) block_of_pose_[pose] = next(6);
  block_of_motion_.assign(states_.motions.size(), -1);
  for (std::size_t i = 0; i < states_.motions.size(); ++i)
    if (evaluation_->motion_moves(i)) block_of_motion_[i] = next(9);
  world_moves_ = evaluation_->world_moves();
  if (const auto count = std::count(world_moves_.begin(), world_moves_.end(), true)) next(static_cast<int>(count));
  terms_.clear();
  for (const FactorEvaluation::Factor& factor : evaluation_->factors()) terms_.push_back(term_of(factor));
  analyzed_ = linearised_ = false;
  return true;
}

FactorSystem::Term FactorSystem::term_of(const FactorEvaluation::Factor& factor) const {
  Term term;
  Eigen::Index width = 0;
  const auto add = [&](int block) {
    if (block < 0) return;
    const auto number = static_cast<std::size_t>(block);
    term.blocks.push_back({number, width, first_of_block_[number], sizes_[number]});
    width += sizes_[number];
  };
  for (const std::uint32_t pose : factor.poses)
    if (pose != FactorEvaluation::none) add(block_of_pose_[pose]);
  for (const std::uint32_t motion : factor.motions)
    if (motion != FactorEvaluation::none) add(block_of_motion_[motion]);
  if (factor.has_world && std::count(world_moves_.begin(), world_moves_.end(), true) > 0)
    add(static_cast<int>(sizes_.size()) - 1);
  term.hessian.resize(width, width);
  return term;
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

Eigen::MatrixXd FactorSystem::derivative_of(const FactorEvaluation::Factor& factor, const FactorError& error) const {
  Eigen::Matrix<double, 15, 33> derivative;
  Eigen::Index width = 0;
  const auto add = [&](bool moves, const auto& block) {
    if (!moves) return;
    derivative.middleCols(width, block.cols()) = block;
    width += block.cols();
  };
  for (std::size_t i = 0; i < 2; ++i)
    if (factor.poses[i] != FactorEvaluation::none) add(block_of_pose_[factor.poses[i]] >= 0, error.by_pose[i]);
  for (std::size_t i = 0; i < 2; ++i)
    if (factor.motions[i] != FactorEvaluation::none) add(block_of_motion_[factor.motions[i]] >= 0, error.by_motion[i]);
  if (factor.has_world)
    for (std::size_t i = 0; i < 3; ++i) add(world_moves_[i], error.by_world.col(static_cast<Eigen::Index>(i)));
  return derivative.topLeftCorner(factor.rows, width);
}

void FactorSystem::linearise(const double* poses) {
  if (std::exchange(linearised_, true)) return;
  take_poses(poses, states_);
  gradient_.setZero(size_);
  diagonal_.setZero(size_);
  FactorError error;
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    const FactorEvaluation::Factor& factor = evaluation_->factors()[i];
    evaluation_->evaluate(factor, states_, true, error);
    const Eigen::MatrixXd derivative = derivative_of(factor, error);
    Term& term = terms_[i];
    term.hessian.noalias() = derivative.transpose() * derivative;
    const Eigen::VectorXd gradient = derivative.transpose() * error.residual.head(factor.rows);
    for (const Term::Block& block : term.blocks) {
      gradient_.segment(block.first, block.size) += gradient.segment(block.begin, block.size);
      diagonal_.segment(block.first, block.size) += term.hessian.diagonal().segment(block.begin, block.size);
    }
  }
}

void FactorSystem::analyse(const BlockSystem& visual) {
  cholesky_.begin_structure(sizes_);
  visual.for_each_block(
      [this](std::size_t row, std::size_t column, const double*) { cholesky_.add_block(row, column); });
  for (const Term& term : terms_)
    for (const Term::Block& row : term.blocks)
      for (const Term::Block& column : term.blocks) cholesky_.add_block(row.number, column.number);
  cholesky_.finish_structure();
  analyzed_ = true;
}

void FactorSystem::fill(const BlockSystem& visual, const Eigen::VectorXd& extra) {
  cholesky_.set_zero();
  visual.for_each_block([this](std::size_t row, std::size_t column, const double* block) {
    cholesky_.add(row, column, Eigen::Map<const Eigen::Matrix<double, 6, 6>>(block));
  });
  for (const Term& term : terms_)
    for (const Term::Block& row : term.blocks)
      for (const Term::Block& column : term.blocks)
        if (row.number >= column.number)
          cholesky_.add(row.number, column.number, term.hessian.block(row.begin, column.begin, row.size, column.size));
  for (std::size_t i = free_poses_.size(); i < sizes_.size(); ++i)
    cholesky_.add(i, i, Eigen::MatrixXd(extra.segment(first_of_block_[i], sizes_[i]).asDiagonal()));
}

bool FactorSystem::solve(const BlockSystem& visual, double damping, Eigen::VectorXd& steps,
                         double& predicted_decrease) {
  const auto poses = static_cast<Eigen::Index>(6 * free_poses_.size());
  Eigen::VectorXd solution(size_), extra = Eigen::VectorXd::Zero(size_);
  for (Eigen::Index i = poses; i < size_; ++i) extra[i] = damping * std::clamp(diagonal_[i], 1e-6, 1e32);
  if (!analyzed_) analyse(visual);
  fill(visual, extra);
  if (!cholesky_.factorise()) return false;
  solution.head(poses) = steps;
  solution.tail(size_ - poses) = -gradient_.tail(size_ - poses);
  cholesky_.solve(solution);
  if (!solution.allFinite()) return false;
  for (Eigen::Index i = poses; i < size_; ++i)
    predicted_decrease += 0.5 * (extra[i] * solution[i] * solution[i] - gradient_[i] * solution[i]);
  steps = solution.head(poses);
  move_states(solution);
  return true;
}

void FactorSystem::move_states(const Eigen::VectorXd& steps) {
  for (std::size_t i = 0; i < states_.motions.size(); ++i)
    if (const int block = block_of_motion_[i]; block >= 0)
      moved_states_.motions[i] =
          states_.motions[i] + steps.segment<9>(first_of_block_[static_cast<std::size_t>(block)]);
  moved_states_.world = states_.world;
  Eigen::Index number = size_ - std::count(world_moves_.begin(), world_moves_.end(), true);
  for (std::size_t i = 0; i < 3; ++i)
    if (world_moves_[i]) moved_states_.world[static_cast<Eigen::Index>(i)] += steps[number++];
}

bool FactorSystem::write(BundleProblem& problem) const {
  const auto is_finite = [](const auto& motion) { return motion.allFinite(); };
  if (!std::all_of(states_.motions.begin(), states_.motions.end(), is_finite) || !states_.world.allFinite())
    return false;
  evaluation_->write(states_, problem);
  return true;
}

}  // namespace holdfast::schur_plugin
