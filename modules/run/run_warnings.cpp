// SPDX-License-Identifier: BSD-3-Clause
#include "run_warnings.hpp"

#include <string>
#include <utility>

#include "focal_check.hpp"
#include "holdfast/core/counted.hpp"
#include "holdfast/evaluation/number_text.hpp"
#include "holdfast/run/results.hpp"
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
  if (masks.found >= least_frames && 2 * masks.mostly_movable > masks.found &&
      2 * masks.upper_edge_movable > masks.mostly_movable)
    add_warning(warnings,
                {{},
                 std::to_string(masks.mostly_movable) + " of " + counted(masks.found, "mask") + " of " + segmenter +
                     "cover more than half of the image with classes that can move, its upper edge included in " +
                     std::to_string(masks.upper_edge_movable) +
                     ": are they inverted, or is a class of the background among the movable ones? Look at them with "
                     "`observers: [overlay]`; correct the names of its labels or classes, or `classes` of the filter"});
}

/// The lengths on which the scale of a map depends.
std::string scale_advice(Sensor sensor) {
  switch (sensor) {
    case Sensor::stereo:
      return "Check the baseline of the pair (in metres), the order of its images and `camera`.";
    case Sensor::rgbd:
      return "Check the depth factor of the source, that the depth images belong to the colour images, and `camera`.";
    case Sensor::mono:
      return "Check `camera`, and that the images are of one camera in the order of their time stamps.";
  }
  return "";
}

}  // namespace

std::string unsupported_poses(const RunRecord& record) {
  constexpr std::size_t fewest_starts = 3;  // a recording of one or two frames is one, too
  const std::size_t starts = record.summary.count(TrackingStatus::initialised);
  if (record.summary.count(TrackingStatus::tracked) > 0 || starts < fewest_starts) return "";
  return "no pose is supported by the map: each of the " + counted(record.trajectory.size(), "pose") +
         " is where a map was begun anew, because the next frame found nothing of it. " + scale_advice(record.sensor);
}

Warnings find_warnings(const RunRecord& record) {
  Warnings warnings;
  if (std::string text = unsupported_poses(record); !text.empty()) add_warning(warnings, {{}, std::move(text)});
  find_mask_warnings(record, warnings);
  if (record.focal_ratio)
    if (std::string text = focal_warning(*record.focal_ratio, record.camera); !text.empty())
      add_warning(warnings, {{}, std::move(text)});
  // Only a simulation knows the classes of its pixels; there, a camera that stands still without noise repeats images.
  const bool is_simulated = !record.source.class_names.empty();
  if (is_simulated) return warnings;
  if (std::string text = repetition_warning(record.repeated_images, record.frame_stamps.size()); !text.empty())
    add_warning(warnings, {{}, std::move(text)});
  return warnings;
}

}  // namespace holdfast
