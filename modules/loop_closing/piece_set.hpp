// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace holdfast {

/// Some of the pieces of a map (KeyFrame::piece), of which there are few.
class PieceSet {
 public:
  /// Adds a piece; false if it was there.
  bool add(std::uint32_t piece) {
    if (std::find(pieces_.begin(), pieces_.end(), piece) != pieces_.end()) return false;
    pieces_.push_back(piece);
    return true;
  }

 private:
  std::vector<std::uint32_t> pieces_;
};

}  // namespace holdfast
