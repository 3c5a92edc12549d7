// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/moving_world/segmentation_settings.hpp"

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

template <>
inline constexpr Choice<SegmentedFrames> choice_table<SegmentedFrames>[] = {{"keyframes", SegmentedFrames::keyframes},
                                                                            {"every_n", SegmentedFrames::every_n}};

void SegmentationSettings::describe(ParameterTable<SegmentationSettings>& table) {
  using S = SegmentationSettings;
  table.add("on", &S::frames,
            "which frames are segmented: keyframes only (Zeng et al. 2023), or also every n-th frame, for comparison");
  table.add("every", &S::every, "with on: every_n, the n").range(1, 1000).unit("frames");
  table
      .add("latency", &S::latency,
           "in sequential mode a mask is applied this many frames later, as if a network had taken the time")
      .range(0, 1000)
      .unit("frames");
  table.add("memory", &S::memory, "time after which the confidence of a propagated mask has halved")
      .range(0.01, 1000)
      .unit("s");
  table
      .add("new_view_share", &S::new_view_share,
           "the points of a keyframe wait for its mask, unless less than this share of its static features shows map "
           "points")
      .range(0, 1);
}

}  // namespace holdfast
