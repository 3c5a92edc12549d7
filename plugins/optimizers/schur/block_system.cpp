// SPDX-License-Identifier: BSD-3-Clause
#include "block_system.hpp"

#include <algorithm>

namespace holdfast::schur_plugin {

void BlockSystem::begin_structure(std::size_t poses, bool dense) {
  poses_ = poses;
  dense_ = dense;
  analyzed_ = false;
  exists_.assign(dense ? 0 : poses * poses, false);
  for (std::size_t i = 0; i < poses; ++i) add_block(i, i);
}

void BlockSystem::add_block(std::size_t row, std::size_t column) {
  if (!dense_) exists_[row * poses_ + column] = true;
}

void BlockSystem::finish_structure() {
  first_.assign(1, 0);
  columns_.clear();
  for (std::size_t row = 0; row < poses_; ++row) {
    for (std::size_t column = 0; column <= row; ++column)
      if (dense_ || exists_[row * poses_ + column]) columns_.push_back(static_cast<std::uint32_t>(column));
    first_.push_back(static_cast<std::uint32_t>(columns_.size()));
  }
  if (!dense_) build_sparse_pattern();
  values_.resize(36 * columns_.size());
}

std::uint32_t BlockSystem::block(std::size_t row, std::size_t column) const {
  if (dense_) return first_[row] + static_cast<std::uint32_t>(column);
  const auto begin = columns_.begin() + first_[row], end = columns_.begin() + first_[row + 1];
  return static_cast<std::uint32_t>(std::lower_bound(begin, end, column) - columns_.begin());
}

void BlockSystem::set_zero() { std::fill(values_.begin(), values_.end(), 0.0); }

bool BlockSystem::solve(Eigen::VectorXd& right_hand_side) {
  return (dense_ ? solve_dense(right_hand_side) : solve_sparse(right_hand_side)) && right_hand_side.allFinite();
}

bool BlockSystem::solve_dense(Eigen::VectorXd& right_hand_side) {
  using Block = Eigen::Map<const Eigen::Matrix<double, 6, 6>>;
  const auto size = static_cast<Eigen::Index>(6 * poses_);
  matrix_.resize(size, size);
  for (std::size_t row = 0; row < poses_; ++row)
    for (std::size_t column = 0; column <= row; ++column)
      matrix_.block<6, 6>(6 * static_cast<Eigen::Index>(row), 6 * static_cast<Eigen::Index>(column)) =
          Block(elements(first_[row] + column));
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(matrix_);
  if (factor.info() != Eigen::Success) return false;
  factor.solveInPlace(right_hand_side);
  return true;
}

void BlockSystem::build_sparse_pattern() {
  // Blocks by column: a counting sort of blocks that stand by row.
  std::vector<std::uint32_t> first(poses_ + 1, 0);
  for (const std::uint32_t column : columns_) ++first[column + 1];
  for (std::size_t i = 0; i < poses_; ++i) first[i + 1] += first[i];
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1), rows(columns_.size());
  sparse_order_.resize(columns_.size());
  for (std::uint32_t row = 0; row < poses_; ++row)
    for (std::uint32_t block = first_[row]; block < first_[row + 1]; ++block) {
      const std::uint32_t place = next[columns_[block]]++;
      sparse_order_[place] = block;
      rows[place] = row;
    }
  const auto size = static_cast<Eigen::Index>(6 * poses_);
  sparse_.resize(size, size);
  sparse_.resizeNonZeros(static_cast<Eigen::Index>(36 * columns_.size() - 15 * poses_));
  int entry = 0;
  for (std::size_t column = 0; column < poses_; ++column) {
    for (int c = 0; c < 6; ++c) {
      sparse_.outerIndexPtr()[6 * column + static_cast<std::size_t>(c)] = entry;
      for (std::uint32_t place = first[column]; place < first[column + 1]; ++place)
        for (int r = place == first[column] ? c : 0; r < 6; ++r)
          sparse_.innerIndexPtr()[entry++] = static_cast<int>(6 * rows[place]) + r;
    }
  }
  sparse_.outerIndexPtr()[size] = entry;
}

bool BlockSystem::solve_sparse(Eigen::VectorXd& right_hand_side) {
  double* value = sparse_.valuePtr();
  std::size_t begin = 0;
  for (std::size_t column = 0; column < poses_; ++column) {
    std::size_t end = begin;
    while (end < sparse_order_.size() && columns_[sparse_order_[end]] == column) ++end;
    for (int c = 0; c < 6; ++c)
      for (std::size_t place = begin; place < end; ++place) {
        const double* block = elements(sparse_order_[place]) + 6 * c;
        for (int r = place == begin ? c : 0; r < 6; ++r) *value++ = block[r];
      }
    begin = end;
  }
  if (!analyzed_) factor_.analyzePattern(sparse_);
  analyzed_ = true;
  factor_.factorize(sparse_);
  if (factor_.info() != Eigen::Success || !(factor_.vectorD().array() > 0.0).all()) return false;
  right_hand_side = factor_.solve(right_hand_side).eval();
  return factor_.info() == Eigen::Success;
}

}  // namespace holdfast::schur_plugin
