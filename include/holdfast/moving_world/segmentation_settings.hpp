// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

template <class Settings>
class ParameterTable;

/// The frames that are segmented.
enum class SegmentedFrames {
  keyframes,  ///< keyframes only, as in Zeng et al. 2023
  every_n,    ///< keyframes and every n-th frame, for comparison
};

/// The `segmentation` section of a configuration: selection of the segmented frames, and latency of their masks.
struct SegmentationSettings {
  SegmentedFrames frames = SegmentedFrames::keyframes;
  int every = 5;  ///< interval of segmented frames with every_n [frames]
  /// Latency of a mask in sequential mode [frames]. For comparison, in threaded mode at 30 frames/s on two cores the
  /// masks of `unet` are one frame old in the median and at most two in 95 % of the cases; with the engine `opencv` two
  /// in the median.
  int latency = 3;
  double memory = 1.0;  ///< time after which the confidence of a propagated mask has halved [s]
  /// Share of static features with map points below which a keyframe creates its points at once instead of waiting for
  /// its mask, so that tracking of an unmapped view is not lost meanwhile.
  double new_view_share = 0.3;

  static void describe(ParameterTable<SegmentationSettings>& table);
};

}  // namespace holdfast
