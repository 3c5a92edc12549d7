// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "holdfast/geometry/warp.hpp"
#include "holdfast/interfaces/dynamic_filter.hpp"
#include "holdfast/settings/multi_view_depth.hpp"

namespace holdfast::multi_view_depth_plugin {

/// Compares dense depth with keyframes before features are matched: every block of the frame is projected into
/// keyframes with the predicted pose. If a keyframe observed a greater depth, it observed free space, and the surface
/// has moved there since. If the depths agree, the surface is confirmed. Moving regions grow along continuous depth,
/// but not into surfaces that old keyframes confirm. Map points in front of the observed surface get negative evidence.
///
/// After Bescos et al. 2018, section III-B, who project the points of the five most overlapping keyframes and compare
/// projected with measured depth; here all blocks of a coarse image are compared in both directions with keyframes of
/// different ages.
class MultiViewDepth final : public DynamicFilter {
 public:
  MultiViewDepth(const MultiViewDepthSettings& settings, const CreationContext& context);

  Needs needs() const override { return {.depth = true, .pose_prior = true}; }
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
  void evaluate_features(const FilterContext& context, StaticEvidence& evidence) const;
  bool is_at_edge(const CoarseGrid& grid, float x, float y, float reach) const;
  void evaluate_points(const FilterContext& context, StaticEvidence& evidence);
  void evaluate_cells(const CoarseGrid& grid, StaticEvidence& evidence) const;

  MultiViewDepthSettings settings_;
  std::vector<Candidate> candidates_;
  std::vector<View> views_;
  int columns_ = 0, rows_ = 0;  // blocks
  Eigen::ArrayXf rays_x_;
  geometry::WarpedRow warped_;
  std::vector<std::int32_t> cells_;  // of a keyframe, where a row of blocks lies
  std::vector<float> depth_, through_, same_, score_;
  std::vector<std::uint8_t> moving_, evaluated_;
  std::vector<int> front_, next_front_;
};

}  // namespace holdfast::multi_view_depth_plugin
