// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

/// The `dense_map` section of a configuration: what is kept of keyframes, and how it becomes a cloud.
struct DenseMapSettings {
  bool enabled = false;
  int step = 2;
  int keyframes = 250;
  std::vector<std::string> classes = {"person"};
  int dilate = 12;
  int edge = 4;
  double depth_margin = 0.15;
  double maximum_depth = 4.0;
  double voxel_size = 0.01;
  int minimum_views = 2;
  double see_through_margin = 0.04;

  static void describe(ParameterTable<DenseMapSettings>& table) {
    using S = DenseMapSettings;
    table.add("enabled", &S::enabled, "keep keyframes' images, so that static_map.ply is a dense coloured cloud");
    table.add("step", &S::step, "one of this many pixels is kept, along rows and columns").range(1, 16).unit("px");
    table
        .add("keyframes", &S::keyframes,
             "most that are kept, 5 bytes a kept pixel each; beyond it, those nearest in time to others go")
        .range(2, 65000);
    table.add("classes", &S::classes, "names of the segmenter's classes that do not belong to the static scene");
    table
        .add("dilate", &S::dilate,
             "what is this near to something that is left out, at its depth or without one, is left out too")
        .range(0, 64)
        .unit("px");
    table.add("edge", &S::edge, "what is this near is left out, whatever its depth").range(0, 64).unit("px");
    table.add("depth_margin", &S::depth_margin, "difference of depths up to which things are at one depth")
        .range(0, 10)
        .unit("m");
    table.add("maximum_depth", &S::maximum_depth, "farther depth is too inexact for the cloud")
        .range(0.1, 16)
        .unit("m");
    table.add("voxel_size", &S::voxel_size, "the cloud has one point in a cube of this size").range(0.001, 1).unit("m");
    table.add("minimum_views", &S::minimum_views, "keyframes that must have seen a point").range(1, 1000);
    table
        .add("see_through_margin", &S::see_through_margin,
             "a keyframe sees through a point when its depth there is greater by this, plus 1 % of the depth's square")
        .range(0.001, 10)
        .unit("m");
  }
};

}  // namespace holdfast
