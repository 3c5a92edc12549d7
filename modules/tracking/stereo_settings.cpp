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
  table.add("dense", &S::dense,
            "depth images of a pair, which are computed where something needs them: filters, masks, dense_map or "
            "surface; sgbm = semi-global matching");
  table.add(
      "self_calibration", &S::self_calibration,
      "whether errors of the calibration of the pair are corrected: fixed = by the errors given below; estimated = the "
      "same, and they are estimated while tracking, from the rows of both images and from motion");
  table
      .add("rotation_x", &S::rotation_x,
           "error of the calibration: rotation of the right camera against the left one, about the axis to the right")
      .range(-0.05, 0.05)
      .unit("rad");
  table.add("rotation_y", &S::rotation_y, "the same about the axis downwards").range(-0.05, 0.05).unit("rad");
  table.add("rotation_z", &S::rotation_z, "the same about the optical axis").range(-0.05, 0.05).unit("rad");
  table.add("focal_ratio", &S::focal_ratio, "error of the calibration: ratio of the focal lengths, right to left")
      .range(0.9, 1.1);
  table
      .add("column_offset", &S::column_offset,
           "error of the calibration: how much farther to the right the principal point of the right camera lies")
      .range(-100, 100)
      .unit("px");
  table
      .add("radial", &S::radial,
           "error of the calibration: radial distortion of the right camera (k1) that the left one does not have")
      .range(-0.1, 0.1);
  table
      .add("decentring", &S::decentring,
           "error of the calibration: decentring distortion of the right camera (p2), beyond what a rotation about the "
           "axis downwards would do")
      .range(-0.1, 0.1);
}

}  // namespace holdfast
