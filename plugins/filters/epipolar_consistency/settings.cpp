// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/settings/epipolar_consistency.hpp"

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

void EpipolarConsistencySettings::describe(ParameterTable<EpipolarConsistencySettings>& table) {
  using S = EpipolarConsistencySettings;
  table.add("threshold", &S::threshold, "distance from the epipolar line above which a feature is moving")
      .range(0.1, 50.0)
      .unit("px");
  table.add("parallax", &S::parallax, "residual of the best homography above which a feature has parallax")
      .range(0.1, 50.0)
      .unit("px");
  table
      .add("parallax_share", &S::parallax_share,
           "minimum fraction of the inliers with parallax; below it the filter adds no evidence")
      .range(0.05, 1.0);
  table
      .add("support", &S::support,
           "minimum inlier fraction of the trusted features; below it the filter adds no evidence")
      .range(0.3, 1.0);
  table.add("gap", &S::gap, "number of frames back to the reference image").range(1, 8).unit("frame");
  table.add("features", &S::features, "maximum number of tracked features, evenly sampled from the frame's list")
      .range(50, 100000);
  table.add("moving", &S::moving, "subtracted from the log-odds of a feature that violates the epipolar constraint")
      .range(0.0, 20.0);
  table.add("static", &S::fixed, "added to the log-odds of a feature that satisfies the epipolar constraint")
      .range(0.0, 20.0);
}

}  // namespace holdfast
