// SPDX-License-Identifier: BSD-3-Clause
// The sparse factorisation of `schur` against a dense one.
#include "schur/block_cholesky.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <utility>
#include <vector>

#include "holdfast/core/random.hpp"

namespace holdfast::schur_plugin {
namespace {

/// A matrix of blocks as in a bundle adjustment with inertia: poses of which some share points, a chain of motions, and
/// a world that is linked to all.
struct Chain {
  std::vector<int> sizes;
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
};

Chain chain_of(std::size_t poses, Random& random) {
  Chain chain;
  chain.sizes.assign(poses, 6);
  chain.sizes.insert(chain.sizes.end(), poses, 9);
  chain.sizes.push_back(3);
  for (std::size_t i = 0; i < poses; ++i) {
    for (std::size_t k = 0; k < i; ++k)
      if (i - k < 4 || random.uniform() < 0.02) chain.pairs.emplace_back(i, k);
    const std::size_t next = std::min(i + 1, poses - 1), world = 2 * poses;
    for (const std::size_t other : {i, next, poses + next, world}) chain.pairs.emplace_back(poses + i, other);
    chain.pairs.emplace_back(i, poses + next);
    chain.pairs.emplace_back(i, world);
  }
  return chain;
}

/// Adds random values to most pairs of the structure, as when observations were left out, and to the diagonal; returns
/// the dense matrix.
Eigen::MatrixXd fill(const Chain& chain, BlockCholesky& cholesky, Random& random) {
  std::vector<Eigen::Index> first(1, 0);
  for (const int size : chain.sizes) first.push_back(first.back() + size);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(first.back(), first.back());
  cholesky.set_zero();
  for (const auto& [row, column] : chain.pairs) {
    if (row == column || random.uniform() < 0.2) continue;
    const Eigen::MatrixXd values =
        Eigen::MatrixXd::NullaryExpr(chain.sizes[row], chain.sizes[column], [&] { return random.normal(); });
    cholesky.add(row, column, values);
    dense.block(first[row], first[column], values.rows(), values.cols()) += values;
    dense.block(first[column], first[row], values.cols(), values.rows()) += values.transpose();
  }
  for (std::size_t i = 0; i < chain.sizes.size(); ++i) {
    const Eigen::MatrixXd values = 300.0 * Eigen::MatrixXd::Identity(chain.sizes[i], chain.sizes[i]);
    cholesky.add(i, i, values);
    dense.block(first[i], first[i], values.rows(), values.cols()) += values;
  }
  return dense;
}

void analyse(const Chain& chain, BlockCholesky& cholesky) {
  cholesky.begin_structure(chain.sizes);
  for (const auto& [row, column] : chain.pairs) cholesky.add_block(row, column);
  cholesky.finish_structure();
}

TEST(BlockCholesky, SolvesAsADenseFactorisation) {
  for (const std::size_t poses : {1, 2, 5, 40}) {
    Random random(poses);
    BlockCholesky cholesky;
    const Chain chain = chain_of(poses, random);
    analyse(chain, cholesky);
    for (int repeated = 0; repeated < 2; ++repeated) {
      const Eigen::MatrixXd dense = fill(chain, cholesky, random);
      const Eigen::VectorXd right = Eigen::VectorXd::NullaryExpr(dense.rows(), [&] { return random.normal(); });
      Eigen::VectorXd solution = right;
      ASSERT_TRUE(cholesky.factorise()) << poses;
      cholesky.solve(solution);
      const Eigen::VectorXd expected = dense.llt().solve(right);
      EXPECT_LT((solution - expected).norm(), 1e-11 * expected.norm()) << poses << " poses";
    }
  }
}

TEST(BlockCholesky, TellsThatAMatrixIsNotPositiveDefiniteAndGoesOn) {
  Random random(1);
  BlockCholesky cholesky;
  const Chain chain = chain_of(10, random);
  analyse(chain, cholesky);
  fill(chain, cholesky, random);
  cholesky.add(13, 13, -1000.0 * Eigen::MatrixXd::Identity(9, 9));
  EXPECT_FALSE(cholesky.factorise());
  const Eigen::MatrixXd dense = fill(chain, cholesky, random);
  Eigen::VectorXd solution = Eigen::VectorXd::Ones(dense.rows());
  ASSERT_TRUE(cholesky.factorise());
  cholesky.solve(solution);
  EXPECT_LT((dense * solution - Eigen::VectorXd::Ones(dense.rows())).norm(), 1e-11);
}

}  // namespace
}  // namespace holdfast::schur_plugin
