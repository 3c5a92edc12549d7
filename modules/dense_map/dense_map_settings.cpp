// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/dense_map/dense_map_settings.hpp"

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

void DenseMapSettings::describe(ParameterTable<DenseMapSettings>& table) {
  using S = DenseMapSettings;
  table.add("enabled", &S::enabled, "keep the images of keyframes and write static_map.ply as a dense coloured cloud");
  table.add("step", &S::step, "every n-th pixel along rows and columns is kept").range(1, 16).unit("px");
  table
      .add("keyframes", &S::keyframes,
           "maximum number of kept keyframes, 5 bytes per kept pixel each; beyond it, keyframes close in time to "
           "others are dropped")
      .range(2, 65000);
  table.add("classes", &S::classes, "names of the segmenter's classes that are not part of the static scene");
  table
      .add("dilate", &S::dilate,
           "pixels within this distance of an excluded pixel are excluded if they have its depth or no depth")
      .range(0, 64)
      .unit("px");
  table.add("edge", &S::edge, "pixels within this distance of an excluded pixel are excluded for any depth")
      .range(0, 64)
      .unit("px");
  table.add("depth_margin", &S::depth_margin, "maximum depth difference of pixels on one surface")
      .range(0, 10)
      .unit("m");
  table.add("maximum_depth", &S::maximum_depth, "maximum depth of the cloud; larger depths are too noisy")
      .range(0.1, 16)
      .unit("m");
  table.add("voxel_size", &S::voxel_size, "side of a voxel; the cloud has one point per voxel")
      .range(0.001, 1)
      .unit("m");
  table.add("minimum_views", &S::minimum_views, "minimum number of keyframes that observe a voxel").range(1, 1000);
  table
      .add("see_through_margin", &S::see_through_margin,
           "a keyframe sees through a voxel if its depth is greater by this margin plus 1 % of the squared depth")
      .range(0.001, 10)
      .unit("m");
}

}  // namespace holdfast
