// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

/// The `segmentation` section of a configuration: which frames the segmenter sees, and when its answer counts.
struct SegmentationSettings {
  std::string on = "keyframes";
  int every = 5;
  int latency = 5;
  double memory = 1.0;

  static void describe(ParameterTable<SegmentationSettings>& table) {
    using S = SegmentationSettings;
    table
        .add("on", &S::on,
             "which frames are segmented: keyframes only (Zeng et al. 2023), or also every n-th frame, for comparison")
        .one_of({"keyframes", "every_n"});
    table.add("every", &S::every, "with on: every_n, the n").range(1, 1000).unit("frames");
    table
        .add("latency", &S::latency,
             "in sequential mode a segmentation counts this many frames later, as if a network had taken the time")
        .range(0, 1000)
        .unit("frames");
    table.add("memory", &S::memory, "time after which a mask that is carried along counts for half")
        .range(0.01, 1000)
        .unit("s");
  }
};

}  // namespace holdfast
