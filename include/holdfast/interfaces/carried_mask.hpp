// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace holdfast {

/// Which class is where in a frame, as carried there from the last segmentation. On the cells of the frame's
/// CoarseView.
struct CarriedMask {
  std::vector<std::uint8_t> labels;      ///< index into the segmenter's classes; 255 = unknown. Empty: no mask yet
  std::vector<std::uint8_t> confidence;  ///< 255 = certain; falls with the age of what the label comes from
  double age = 0.0;                      ///< since the newest segmented frame that it comes from [s]

  bool empty() const { return labels.empty(); }
};

}  // namespace holdfast
