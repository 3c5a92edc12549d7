// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "holdfast/core/frame.hpp"

namespace holdfast {

/// Label of a frame's mask in the cell of a feature: an index into the segmenter's classes, or CellMask::unknown
/// without a mask.
inline std::uint8_t feature_label(const Frame& frame, std::size_t feature) {
  const CoarseView& coarse = frame.coarse;
  if (coarse.mask.labels.size() != static_cast<std::size_t>(coarse.grid.size())) return CellMask::unknown;
  const int cell = coarse.grid.cell_of(frame.x[feature], frame.y[feature]);
  return cell < 0 ? CellMask::unknown : coarse.mask.labels[static_cast<std::size_t>(cell)];
}

}  // namespace holdfast
