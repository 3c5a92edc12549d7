// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "holdfast/interfaces/dynamic_filter.hpp"
#include "holdfast/plugin/plugin.hpp"

namespace holdfast {

struct MultiViewDepthSettings {
  int keyframes = 8;
  int point_keyframes = 3;
  double reach = 1.0;
  double margin = 0.06;
  double margin_slope = 0.03;
  double sure = 0.7;
  int growth = 12;
  double moving_log_odds = -4.0;
  double static_log_odds = 1.0;
  double edge = 4.0;
  double edge_log_odds = -3.0;
  double crowd_log_odds = -5.0;

  static void describe(ParameterTable<MultiViewDepthSettings>& table) {
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
};

/// Judges by dense depth, before features are matched: every block of the frame is carried into keyframes with the
/// predicted pose. Where a keyframe saw farther, there was free space: what is there now has come since. Where the
/// depths agree, the surface was there then. Moving regions grow in depth, but not into what old keyframes confirm.
/// And map points in front of what the frame sees are gone.
///
/// After Bescos et al. 2018, section III-B, who project points of the five best overlapping keyframes and compare
/// projected with measured depth; here all blocks of a coarse image are compared, both ways, with keyframes of
/// different ages.
class MultiViewDepth final : public DynamicFilter {
 public:
  MultiViewDepth(const MultiViewDepthSettings& settings, const CreationContext& context);

  Needs needs() const override { return {.depth = true, .pose_prior = true, .map = true}; }
  void apply(const FilterContext& context, StaticEvidence& evidence) override;

 private:
  struct Candidate {
    KeyFrameId id;
    std::size_t group;
    double cost;
  };
  struct View {
    const Frame* frame;
    float through, same;
  };
  static constexpr int stride = 2;  // cells of the coarse view in a block

  void choose_keyframes(const FilterContext& context);
  void compare(const FilterContext& context);
  void grow();
  void judge_features(const FilterContext& context, StaticEvidence& evidence) const;
  bool is_at_edge(const CoarseGrid& grid, float x, float y, float reach) const;
  void judge_points(const FilterContext& context, StaticEvidence& evidence);

  MultiViewDepthSettings settings_;
  std::vector<Candidate> candidates_;
  std::vector<View> views_;
  int columns_ = 0, rows_ = 0;  // blocks
  std::vector<float> depth_, through_, same_, score_;
  std::vector<std::uint8_t> moving_, judged_;
  std::vector<int> front_, next_front_;
};

}  // namespace holdfast
