// SPDX-License-Identifier: BSD-3-Clause
// In place of block_tree.cpp in builds without OpenVDB.
#include "block_tree.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast::surface {

struct BlockTree::Tree {};

BlockTree::BlockTree() {
  throw Error(
      "this build of Holdfast has no OpenVDB, which surfaces need; install it "
      "(`sh cmake/install_dependencies.sh --surface`), configure and build again");
}
BlockTree::~BlockTree() = default;

bool BlockTree::is_available() { return false; }
std::int32_t BlockTree::find(const Eigen::Vector3i&) const { return -1; }
void BlockTree::set(const Eigen::Vector3i&, std::int32_t) {}
void BlockTree::clear() {}

}  // namespace holdfast::surface
