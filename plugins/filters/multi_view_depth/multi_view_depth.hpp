// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "holdfast/interfaces/dynamic_filter.hpp"
#include "holdfast/settings/multi_view_depth.hpp"

namespace holdfast {

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
