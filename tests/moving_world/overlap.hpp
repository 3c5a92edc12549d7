// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace holdfast::test {

/// Intersection over union of the cells that carry a label; 1 when nobody has it.
inline double overlap(const std::vector<std::uint8_t>& labels, const std::vector<std::uint8_t>& truth,
                      std::uint8_t label = 1) {
  std::size_t both = 0, any = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    both += labels[i] == label && truth[i] == label ? 1 : 0;
    any += labels[i] == label || truth[i] == label ? 1 : 0;
  }
  return any == 0 ? 1.0 : static_cast<double>(both) / static_cast<double>(any);
}

}  // namespace holdfast::test
