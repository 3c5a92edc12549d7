// SPDX-License-Identifier: BSD-3-Clause
#include "run_warnings.hpp"

#include <string>
#include <utility>

#include "holdfast/core/counted.hpp"
#include "repeated_images.hpp"

namespace holdfast {

namespace {

void find_mask_warnings(const RunRecord& record, Warnings& warnings) {
  const MaskCounts& masks = record.masks;
  const std::string segmenter = "the segmenter '" + record.configuration.segmenter.name + "' ";
  constexpr std::size_t least_frames = 3;
  if (masks.segmented >= least_frames && masks.found == 0)
    add_warning(warnings, {{},
                           segmenter + "had no mask for any of the " + counted(masks.segmented, "frame") +
                               " that it was given, so that nothing was masked; check its files or its results with "
                               "`holdfast segment`"});
  if (masks.found >= least_frames && 2 * masks.mostly_movable > masks.found)
    add_warning(warnings,
                {{},
                 std::to_string(masks.mostly_movable) + " of " + counted(masks.found, "mask") + " of " + segmenter +
                     "cover more than half of the image with classes that can move: are they inverted, or is a "
                     "class of the background among the movable ones? Look at them with `observers: [overlay]`; "
                     "correct the names of its labels or classes, or `classes` of the filter"});
}

}  // namespace

Warnings find_warnings(const RunRecord& record) {
  Warnings warnings;
  find_mask_warnings(record, warnings);
  if (std::string text = repetition_warning(record.repeated_images, record.frame_stamps.size()); !text.empty())
    add_warning(warnings, {{}, std::move(text)});
  return warnings;
}

}  // namespace holdfast
