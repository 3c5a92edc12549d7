// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace holdfast {

/// A small set of submaps (KeyFrame::submap).
class SubmapSet {
 public:
  /// Adds a submap; false if it is contained already.
  bool add(std::uint32_t submap) {
    if (std::find(submaps_.begin(), submaps_.end(), submap) != submaps_.end()) return false;
    submaps_.push_back(submap);
    return true;
  }

 private:
  std::vector<std::uint32_t> submaps_;
};

}  // namespace holdfast
