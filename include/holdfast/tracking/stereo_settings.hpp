// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

template <class Settings>
class ParameterTable;

/// The `stereo` section of a configuration: how the features of the left image get their depth from the right one.
struct StereoSettings {
  double minimum_depth = 0.4;  ///< [m]; nearer surfaces have no depth
  double row_tolerance = 2.0;  ///< px at level 0, times the scale of the feature: of keypoints, and of rectification
  /// Between the descriptors of both images; 0 = halfway between the extractor's strict and loose distance, 75 bits for
  /// ORB (Mur-Artal and Tardos 2017).
  double maximum_distance = 0.0;
  int patch_radius = 5;            ///< px; half the width of the patch by which the disparity is refined
  double minimum_disparity = 0.5;  ///< px; farther features have no depth

  static void describe(ParameterTable<StereoSettings>& table);
};

}  // namespace holdfast
