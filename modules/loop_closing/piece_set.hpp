// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace holdfast {

/// A small set of submaps (KeyFrame::piece).
class PieceSet {
 public:
  /// Adds a submap; false if it is contained already.
  bool add(std::uint32_t piece) {
    if (std::find(pieces_.begin(), pieces_.end(), piece) != pieces_.end()) return false;
    pieces_.push_back(piece);
    return true;
  }

 private:
  std::vector<std::uint32_t> pieces_;
};

}  // namespace holdfast
