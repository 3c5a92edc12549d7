// SPDX-License-Identifier: BSD-3-Clause
#include "block_cholesky.hpp"

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <iterator>
#include <numeric>

namespace holdfast::schur_plugin {

void BlockCholesky::begin_structure(std::vector<int> sizes) {
  sizes_ = std::move(sizes);
  pairs_.clear();
  first_number_.assign(1, 0);
  for (const int size : sizes_) first_number_.push_back(first_number_.back() + size);
}

void BlockCholesky::add_block(std::size_t row, std::size_t column) {
  if (row != column)
    pairs_.emplace_back(static_cast<std::uint32_t>(std::max(row, column)),
                        static_cast<std::uint32_t>(std::min(row, column)));
}

void BlockCholesky::finish_structure() {
  std::sort(pairs_.begin(), pairs_.end());
  pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
  order();
  make_panels(find_rows());
}

void BlockCholesky::order() {
  const auto count = static_cast<int>(sizes_.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < count; ++i) entries.emplace_back(i, i, 1.0);
  for (const auto& [row, column] : pairs_) {
    entries.emplace_back(static_cast<int>(row), static_cast<int>(column), 1.0);
    entries.emplace_back(static_cast<int>(column), static_cast<int>(row), 1.0);
  }
  Eigen::SparseMatrix<double> pattern(count, count);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  Eigen::AMDOrdering<int>()(pattern, permutation);
  position_.resize(sizes_.size()), block_at_.resize(sizes_.size());
  for (int i = 0; i < count; ++i) {
    const auto block = static_cast<std::uint32_t>(permutation.indices()[i]);
    block_at_[static_cast<std::size_t>(i)] = block;
    position_[block] = static_cast<std::uint32_t>(i);
  }
}

std::vector<std::vector<std::uint32_t>> BlockCholesky::find_rows() const {
  std::vector<std::vector<std::uint32_t>> rows(sizes_.size());
  for (const auto& [row, column] : pairs_) {
    const auto [first, second] = std::minmax(position_[row], position_[column]);
    rows[first].push_back(second);
  }
  // The rows of a column, without the first one, are rows of its parent in the elimination tree: that first one.
  std::vector<std::vector<std::uint32_t>> children(sizes_.size());
  std::vector<std::uint32_t> merged;
  for (std::uint32_t column = 0; column < rows.size(); ++column) {
    std::sort(rows[column].begin(), rows[column].end());
    for (const std::uint32_t child : children[column]) {
      merged.clear();
      std::set_union(rows[column].begin(), rows[column].end(), rows[child].begin() + 1, rows[child].end(),
                     std::back_inserter(merged));
      rows[column].swap(merged);
    }
    if (!rows[column].empty()) children[rows[column].front()].push_back(column);
  }
  return rows;
}

void BlockCholesky::make_panels(const std::vector<std::vector<std::uint32_t>>& rows) {
  constexpr double most_zeros = 0.2;  // of a panel's blocks: wider panels are worth some
  panels_.clear();
  panel_of_.resize(rows.size());
  double zeros = 0.0;
  for (std::size_t begin = 0, column = 0; column < rows.size(); ++column) {
    const std::size_t next = column + 1, width = next - begin;
    const bool is_parent = next < rows.size() && !rows[column].empty() && rows[column].front() == next;
    if (is_parent) {
      const auto more = static_cast<double>(width * (rows[next].size() + 1 - rows[column].size()));
      const auto blocks = static_cast<double>((width + 1) * (width + 2) / 2 + (width + 1) * rows[next].size());
      if (zeros + more <= most_zeros * blocks) {
        zeros += more;
        continue;
      }
    }
    add_panel(begin, next, rows[column]);
    begin = next;
    zeros = 0.0;
  }
}

void BlockCholesky::add_panel(std::size_t begin, std::size_t end, const std::vector<std::uint32_t>& rows) {
  Panel panel;
  panel.own = end - begin;
  panel.blocks.resize(panel.own);
  std::iota(panel.blocks.begin(), panel.blocks.end(), static_cast<std::uint32_t>(begin));
  panel.blocks.insert(panel.blocks.end(), rows.begin(), rows.end());
  panel.offset.assign(1, 0);
  for (const std::uint32_t position : panel.blocks)
    panel.offset.push_back(panel.offset.back() + sizes_[block_at_[position]]);
  panel.values.resize(panel.offset.back(), panel.offset[panel.own]);
  for (std::size_t i = begin; i < end; ++i) panel_of_[i] = static_cast<std::uint32_t>(panels_.size());
  panels_.push_back(std::move(panel));
}

void BlockCholesky::set_zero() {
  for (Panel& panel : panels_) panel.values.setZero();
}

Eigen::Index BlockCholesky::offset_in(const Panel& panel, std::uint32_t position) const {
  const auto found = std::lower_bound(panel.blocks.begin(), panel.blocks.end(), position);
  return panel.offset[static_cast<std::size_t>(found - panel.blocks.begin())];
}

void BlockCholesky::add(std::size_t row, std::size_t column, const Eigen::Ref<const Eigen::MatrixXd>& values) {
  const std::uint32_t a = position_[row], b = position_[column];
  Panel& panel = panels_[panel_of_[std::min(a, b)]];
  const Eigen::Index below = offset_in(panel, std::max(a, b)), right = offset_in(panel, std::min(a, b));
  if (a >= b)
    panel.values.block(below, right, values.rows(), values.cols()) += values;
  else
    panel.values.block(below, right, values.cols(), values.rows()) += values.transpose();
}

bool BlockCholesky::factorise() {
  for (Panel& panel : panels_) {
    Eigen::Ref<Eigen::MatrixXd> own = panel.values.topRows(panel.columns());
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> cholesky(own);
    if (cholesky.info() != Eigen::Success) return false;
    if (panel.below() == 0) continue;
    own.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(
        panel.values.bottomRows(panel.below()));
    update_others(panel);
  }
  return true;
}

void BlockCholesky::update_others(const Panel& panel) {
  for (std::size_t begin = panel.own, end = begin; begin < panel.blocks.size(); begin = end) {
    const std::uint32_t target = panel_of_[panel.blocks[begin]];
    while (end < panel.blocks.size() && panel_of_[panel.blocks[end]] == target) ++end;
    update(panel, begin, end, panels_[target]);
  }
}

/// By the rows `begin` to `end` - 1 as columns of the target, and by these and all rows below them.
void BlockCholesky::update(const Panel& panel, std::size_t begin, std::size_t end, Panel& target) {
  const Eigen::Index first = panel.offset[begin], columns = panel.offset[end] - first;
  const Eigen::Index rows = panel.values.rows() - first;
  product_.resize(rows, columns);
  product_.noalias() = panel.values.bottomRows(rows) * panel.values.middleRows(first, columns).transpose();
  std::size_t place = 0;  // in the target: both lists increase
  for (std::size_t row = begin; row < panel.blocks.size(); ++row) {
    while (target.blocks[place] != panel.blocks[row]) ++place;
    const Eigen::Index height = panel.offset[row + 1] - panel.offset[row];
    for (std::size_t column = begin; column < std::min(end, row + 1); ++column) {
      const Eigen::Index width = panel.offset[column + 1] - panel.offset[column];
      target.values.block(target.offset[place], target.offset[panel.blocks[column] - target.blocks[0]], height,
                          width) -=
          product_.block(panel.offset[row] - first, panel.offset[column] - first, height, width);
    }
  }
}

void BlockCholesky::solve(Eigen::VectorXd& right_hand_side) const {
  const auto part = [&](std::uint32_t position) {
    const std::uint32_t block = block_at_[position];
    return right_hand_side.segment(first_number_[block], sizes_[block]);
  };
  Eigen::VectorXd local;
  const auto gather = [&](const Panel& panel) {
    local.resize(panel.values.rows());
    for (std::size_t i = 0; i < panel.blocks.size(); ++i)
      local.segment(panel.offset[i], sizes_[block_at_[panel.blocks[i]]]) = part(panel.blocks[i]);
  };
  const auto scatter = [&](const Panel& panel, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
      part(panel.blocks[i]) = local.segment(panel.offset[i], sizes_[block_at_[panel.blocks[i]]]);
  };
  for (const Panel& panel : panels_) {
    gather(panel);
    auto own = local.head(panel.columns());
    panel.values.topRows(panel.columns()).triangularView<Eigen::Lower>().solveInPlace(own);
    local.tail(panel.below()).noalias() -= panel.values.bottomRows(panel.below()) * own;
    scatter(panel, panel.blocks.size());
  }
  for (auto panel = panels_.rbegin(); panel != panels_.rend(); ++panel) {
    gather(*panel);
    auto own = local.head(panel->columns());
    own.noalias() -= panel->values.bottomRows(panel->below()).transpose() * local.tail(panel->below());
    panel->values.topRows(panel->columns()).triangularView<Eigen::Lower>().transpose().solveInPlace(own);
    scatter(*panel, panel->own);
  }
}

}  // namespace holdfast::schur_plugin
