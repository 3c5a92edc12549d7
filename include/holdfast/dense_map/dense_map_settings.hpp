// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace holdfast {

template <class Settings>
class ParameterTable;

/// Settings of the dense map: the section `dense_map` of a configuration.
struct DenseMapSettings {
  bool enabled = false;  ///< whether the images of keyframes are kept and fused into a dense coloured cloud
  int step = 2;          ///< subsampling of the kept images along rows and columns [px]
  int keyframes = 250;   ///< maximum number of kept keyframes; bounds the memory (96 MB at 640x480 and step 2)
  std::vector<std::string> classes = {"person"};  ///< classes of the segmenter that do not belong to the static scene
  /// Pixels within this distance of an excluded pixel are excluded if they have its depth or no depth [px].
  int dilate = 12;
  int edge = 4;                ///< pixels within this distance of an excluded pixel are excluded for any depth [px]
  double depth_margin = 0.15;  ///< maximum depth difference of pixels of one surface [m]
  /// Maximum depth of the cloud [m]; the noise of depth cameras grows with the square of the depth.
  double maximum_depth = 4.0;
  double voxel_size = 0.01;  ///< side of a voxel; the cloud has one point per voxel [m]
  int minimum_views = 2;     ///< minimum number of keyframes that observe a voxel
  /// A keyframe sees through a voxel if its depth is greater by this margin plus 1 % of the squared depth [m].
  double see_through_margin = 0.04;

  static void describe(ParameterTable<DenseMapSettings>& table);
};

}  // namespace holdfast
