// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/stereo_settings.hpp"

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

void StereoSettings::describe(ParameterTable<StereoSettings>& table) {
  using S = StereoSettings;
  table.add("minimum_depth", &S::minimum_depth, "surfaces nearer than this get no depth").range(0.01, 1000).unit("m");
  table
      .add("row_tolerance", &S::row_tolerance,
           "how far from its row in the left image a feature may lie in the right image, times the scale of its level")
      .range(0, 20)
      .unit("px");
  table
      .add(
          "maximum_distance", &S::maximum_distance,
          "distance of the descriptors of a feature in both images, at most, in the unit of the extractor; 0 = halfway "
          "between its strict and its loose distance (orb: 75 bits)")
      .range(0, 1e6);
  table
      .add("patch_radius", &S::patch_radius,
           "half the width of the image patch by which the column in the right image is refined")
      .range(2, 15)
      .unit("px");
  table.add("minimum_disparity", &S::minimum_disparity, "features with a smaller disparity get no depth")
      .range(0.01, 100)
      .unit("px");
}

}  // namespace holdfast
