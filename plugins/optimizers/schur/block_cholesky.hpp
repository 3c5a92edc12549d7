// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace holdfast::schur_plugin {

/// Supernodal Cholesky factorisation of a symmetric positive definite matrix that is sparse by blocks of different
/// sizes. The order of the blocks is that of an approximate minimum degree; successive block columns with (almost) the
/// same rows form a panel, which is treated as a dense matrix (Davis 2006, "Direct Methods for Sparse Linear Systems",
/// chapters 4 and 7; Ng and Peyton 1993). Where observations and chains of motions fill most of the factor, this is
/// several times as fast as a factorisation by single numbers. Runs on the calling thread; deterministic.
class BlockCholesky {
 public:
  /// Begins a structure with the blocks of the diagonal; `sizes` are the numbers of rows of each of them.
  void begin_structure(std::vector<int> sizes);
  /// Adds the block of two indices, in either order; the same one may be added more than once.
  void add_block(std::size_t row, std::size_t column);
  void finish_structure();

  void set_zero();
  /// Adds values to a block of the structure; blocks without any are zero. Of blocks of the diagonal only the lower
  /// triangle is read.
  void add(std::size_t row, std::size_t column, const Eigen::Ref<const Eigen::MatrixXd>& values);
  /// Replaces the values by their factor. False if the matrix is not positive definite: set_zero() is next.
  bool factorise();
  /// Solves with the factor; the solution replaces the right-hand side.
  void solve(Eigen::VectorXd& right_hand_side) const;

 private:
  /// Successive block columns: their own blocks, then those below, all by position in the order of elimination.
  struct Panel {
    std::vector<std::uint32_t> blocks;
    std::vector<Eigen::Index> offset;  // of each block's first row; one more than blocks
    std::size_t own = 0;               // block columns
    Eigen::MatrixXd values;            // rows x columns
    Eigen::Index columns() const { return values.cols(); }
    Eigen::Index below() const { return values.rows() - values.cols(); }
  };

  void order();
  /// By position, the positions of the rows below the diagonal of the factor, increasing.
  std::vector<std::vector<std::uint32_t>> find_rows() const;
  void make_panels(const std::vector<std::vector<std::uint32_t>>& rows);
  void add_panel(std::size_t begin, std::size_t end, const std::vector<std::uint32_t>& rows);
  Eigen::Index offset_in(const Panel& panel, std::uint32_t position) const;
  /// Subtracts the product of a factorised panel's rows from the panels to its right.
  void update_others(const Panel& panel);
  void update(const Panel& panel, std::size_t begin, std::size_t end, Panel& target);

  std::vector<int> sizes_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs_;  // of the structure, row > column
  std::vector<std::uint32_t> position_, block_at_;              // in the order of elimination, and its inverse
  std::vector<Eigen::Index> first_number_;                      // of each block in a vector
  std::vector<std::uint32_t> panel_of_;                         // by position
  std::vector<Panel> panels_;
  Eigen::MatrixXd product_;
};

}  // namespace holdfast::schur_plugin
