// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/settings/multi_view_depth.hpp"

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

void MultiViewDepthSettings::describe(ParameterTable<MultiViewDepthSettings>& table) {
  using S = MultiViewDepthSettings;
  table.add("keyframes", &S::keyframes, "maximum number of keyframes to compare with, distributed over four age groups")
      .range(1, 100);
  table
      .add("point_keyframes", &S::point_keyframes,
           "number of these keyframes whose map points are compared with the frame's depth")
      .range(0, 100);
  table.add("reach", &S::reach, "maximum distance between the camera centres of frame and keyframe")
      .range(0.01, 100)
      .unit("m");
  table
      .add("margin", &S::margin,
           "a keyframe observed free space if its depth is greater than the frame's by margin + margin_slope * depth")
      .range(0.005, 10)
      .unit("m");
  table.add("margin_slope", &S::margin_slope, "growth of the margin with depth; see margin").range(0, 1);
  table
      .add("confirmed_score", &S::confirmed_score,
           "score of confirming keyframes from which on moving regions do not grow into a block; 1 = one old keyframe")
      .range(0, 10);
  table.add("growth", &S::growth, "maximum number of region-growing steps of 8 px along continuous depth")
      .range(0, 100);
  table.add("moving_log_odds", &S::moving_log_odds, "evidence of surfaces that are measured to move").range(-20, 0);
  table
      .add("edge", &S::edge,
           "features within this distance of a moving region, times the scale of their octave, lie on its outline")
      .range(0, 40)
      .unit("px");
  table.add("edge_log_odds", &S::edge_log_odds, "prior of features on the outline of a moving region").range(-20, 0);
  table
      .add("crowd_log_odds", &S::crowd_log_odds,
           "prior of unconfirmed surfaces if there is no mask, times the fraction of the view that moves")
      .range(-50, 0);
  table.add("static_log_odds", &S::static_log_odds, "maximum evidence of surfaces that keyframes of all ages confirm")
      .range(0, 20);
}

}  // namespace holdfast
