// SPDX-License-Identifier: BSD-3-Clause
#include "block_tree.hpp"

#include <openvdb/tree/Tree.h>
#include <openvdb/tree/ValueAccessor.h>

namespace holdfast::surface {

// The accessor keeps the nodes of the last access: neighbours are found without a descent from the root. The tree does
// not know it (IsSafe is false), so that clear() has to clear both.
struct BlockTree::Tree {
  using Content = openvdb::tree::Tree4<std::int32_t, 5, 4, 3>::Type;
  Content tree{-1};
  openvdb::tree::ValueAccessor<Content, /*IsSafe=*/false> accessor{tree};
};

BlockTree::BlockTree() : tree_(std::make_unique<Tree>()) {}
BlockTree::~BlockTree() = default;

bool BlockTree::is_available() { return true; }

std::int32_t BlockTree::find(const Eigen::Vector3i& block) const {
  return tree_->accessor.getValue(openvdb::Coord(block.x(), block.y(), block.z()));
}

void BlockTree::set(const Eigen::Vector3i& block, std::int32_t number) {
  tree_->accessor.setValue(openvdb::Coord(block.x(), block.y(), block.z()), number);
}

void BlockTree::clear() {
  tree_->accessor.clear();
  tree_->tree.clear();
}

}  // namespace holdfast::surface
