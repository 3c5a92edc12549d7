// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/settings/epipolar_consistency.hpp"

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

void EpipolarConsistencySettings::describe(ParameterTable<EpipolarConsistencySettings>& table) {
  using S = EpipolarConsistencySettings;
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

}  // namespace holdfast
