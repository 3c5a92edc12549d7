// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace holdfast {

/// Class labels on the cells of a CoarseView: a segmentation sampled at the cells' centres, or one that was propagated
/// from an earlier frame. Entry i of each array belongs to cell i.
struct CellMask {
  static constexpr std::uint8_t background = 0;
  static constexpr std::uint8_t unknown = 255;

  std::vector<std::uint8_t> labels;      ///< index into the segmenter's classes; empty = there is no mask
  std::vector<std::uint8_t> confidence;  ///< 255 = certain; it decreases with the age of a propagated mask
  /// 1 where an object was found to move in the last evaluated frame; empty = not evaluated.
  std::vector<std::uint8_t> moving;
  /// Id of the instance, which it keeps from mask to mask, 0 = none; empty if the segmenter separates no instances.
  std::vector<std::uint16_t> instances;
  double age = 0.0;  ///< time since the segmented frame that the mask comes from [s]

  bool empty() const { return labels.empty(); }
  static bool is_object(std::uint8_t label) { return label != background && label != unknown; }
  /// Replaces the mask by one label for all cells, without instances. Keeps the age.
  void assign(std::size_t cells, std::uint8_t label, std::uint8_t certainty) {
    labels.assign(cells, label);
    confidence.assign(cells, certainty);
    moving.assign(cells, 0);
    instances.clear();
  }
  void clear() {
    labels.clear(), confidence.clear(), moving.clear(), instances.clear();
    age = 0.0;
  }
};

}  // namespace holdfast
