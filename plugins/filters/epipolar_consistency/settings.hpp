// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast::epipolar_plugin {

struct EpipolarSettings {
  double threshold = 1.5;
  double parallax = 0.7;
  double parallax_share = 0.35;
  double support = 0.5;
  int gap = 3;
  int features = 500;
  double moving = 2.0;
  double fixed = 0.1;

  static void describe(ParameterTable<EpipolarSettings>& table) {
    using S = EpipolarSettings;
    table.add("threshold", &S::threshold, "a feature farther than this from its epipolar line moves")
        .range(0.1, 50.0)
        .unit("px");
    table.add("parallax", &S::parallax, "a feature this far from where the best homography takes it shows depth")
        .range(0.1, 50.0)
        .unit("px");
    table
        .add("parallax_share", &S::parallax_share,
             "share of the features on their epipolar lines that must show depth; with fewer the filter says nothing")
        .range(0.05, 1.0);
    table
        .add("support", &S::support,
             "share of the trusted features that must lie on their epipolar lines; with fewer it says nothing")
        .range(0.3, 1.0);
    table.add("gap", &S::gap, "frames back to the image that a frame is compared with").range(1, 8).unit("frame");
    table.add("features", &S::features, "followed at most, evenly over the frame's list").range(50, 100000);
    table.add("moving", &S::moving, "taken from the log-odds of a feature that is far from its line").range(0.0, 20.0);
    table.add("static", &S::fixed, "added to the log-odds of a feature that is near its line").range(0.0, 20.0);
  }
};

}  // namespace holdfast::epipolar_plugin
