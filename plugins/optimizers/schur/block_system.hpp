// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <cstdint>
#include <vector>

namespace holdfast::schur_plugin {

/// A symmetric positive definite system in blocks of 6 x 6, one row of blocks per pose, of which the lower triangle is
/// stored: the reduced camera system of bundle adjustment, or the normal equations of a pose graph. Solved as a dense
/// matrix, or by a sparse Cholesky factorisation with a fill-reducing order (Triggs et al. 2000, section 6.3).
class BlockSystem {
 public:
  /// Begins a system of `poses` rows of blocks with the blocks of the diagonal. All further blocks are added before
  /// finish_structure().
  void begin_structure(std::size_t poses, bool dense);
  /// Adds a block, column <= row; in a dense system all blocks exist.
  void add_block(std::size_t row, std::size_t column);
  void finish_structure();

  bool is_dense() const { return dense_; }
  std::size_t poses() const { return poses_; }
  std::size_t block_count() const { return first_.back(); }
  /// Index of the block, column <= row, that the structure must contain.
  std::uint32_t block(std::size_t row, std::size_t column) const;
  /// The block's elements, column by column.
  double* elements(std::size_t block) { return values_.data() + 36 * block; }
  void set_zero();
  /// Calls function(row, column, elements) for each block in the order of rows and columns.
  template <class Function>
  void for_each_block(Function&& function) const {
    for (std::size_t row = 0; row < poses_; ++row)
      for (std::uint32_t block = first_[row]; block < first_[row + 1]; ++block)
        function(row, static_cast<std::size_t>(columns_[block]), values_.data() + std::size_t{36} * block);
  }

  /// Solves for the right-hand side, six numbers per pose; the solution replaces it. Returns false if the matrix is not
  /// positive definite or the solution not finite.
  bool solve(Eigen::VectorXd& right_hand_side);

 private:
  bool solve_dense(Eigen::VectorXd& right_hand_side);
  bool solve_sparse(Eigen::VectorXd& right_hand_side);
  void build_sparse_pattern();

  std::size_t poses_ = 0;
  bool dense_ = true;
  bool analyzed_ = false;
  std::vector<std::uint32_t> first_;    // of the blocks of each row; poses + 1
  std::vector<std::uint32_t> columns_;  // of each block, in the order of rows and columns
  std::vector<bool> exists_;            // poses x poses, while the structure is built
  std::vector<double> values_;
  Eigen::MatrixXd matrix_;
  Eigen::SparseMatrix<double> sparse_;       // lower triangle
  std::vector<std::uint32_t> sparse_order_;  // blocks in the order of columns and rows
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
};

}  // namespace holdfast::schur_plugin
