// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>

namespace holdfast::surface {

/// Sparse map from block coordinates to numbers. A plain interface, so that only one file reads OpenVDB.
class BlockTree {
 public:
  BlockTree();
  ~BlockTree();

  static bool is_available();
  /// The number of a block, or -1.
  std::int32_t find(const Eigen::Vector3i& block) const;
  void set(const Eigen::Vector3i& block, std::int32_t number);
  void clear();

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace holdfast::surface
