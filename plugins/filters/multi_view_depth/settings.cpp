// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/settings/multi_view_depth.hpp"

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

void MultiViewDepthSettings::describe(ParameterTable<MultiViewDepthSettings>& table) {
  using S = MultiViewDepthSettings;
  table.add("keyframes", &S::keyframes, "keyframes of all ages to compare with, at most").range(1, 100);
  table.add("point_keyframes", &S::point_keyframes, "of these, whose map points are looked for in the frame's depth")
      .range(0, 100);
  table.add("reach", &S::reach, "distance of a keyframe, at most").range(0.01, 100).unit("m");
  table
      .add("margin", &S::margin,
           "a keyframe that saw this much farther, plus margin_slope times the depth, saw through what is there now")
      .range(0.005, 10)
      .unit("m");
  table.add("margin_slope", &S::margin_slope, "see margin").range(0, 1);
  table.add("sure", &S::sure, "moving regions do not grow into what keyframes confirm this much; 1 = one old sight")
      .range(0, 10);
  table.add("growth", &S::growth, "steps of 8 px that a moving region grows where depth goes on").range(0, 100);
  table.add("moving_log_odds", &S::moving_log_odds, "said of what moves").range(-20, 0);
  table
      .add("edge", &S::edge,
           "features this near to what moves, times the scale of their octave, are seen against its outline")
      .range(0, 40)
      .unit("px");
  table.add("edge_log_odds", &S::edge_log_odds, "said of these").range(-20, 0);
  table
      .add("crowd_log_odds", &S::crowd_log_odds,
           "said, times the share of the view that moves, of what no keyframe of some age confirms, when no mask "
           "tells people from things")
      .range(-50, 0);
  table.add("static_log_odds", &S::static_log_odds, "said of what keyframes of all ages confirm").range(0, 20);
}

}  // namespace holdfast
