// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "feature_flow.hpp"
#include "holdfast/core/random.hpp"
#include "holdfast/interfaces/dynamic_filter.hpp"
#include "holdfast/settings/epipolar_consistency.hpp"
#include "two_views.hpp"

namespace holdfast::epipolar_consistency_plugin {

/// Moving consistency check after DS-SLAM (Yu, Liu, Liu, Xie, Yang, Wei, Fei: DS-SLAM, IROS 2018, section II-C):
/// features are tracked between two images, a fundamental matrix is estimated by RANSAC, and a feature is moving if its
/// distance from its epipolar line exceeds a threshold. Differences from the paper: features that are already
/// classified as dynamic (static_probability below 0.5, or negative evidence of earlier filters) do not take part in
/// the estimation, and no evidence is added if the epipolar geometry is degenerate (Verdict). The evidence is
/// measurements. The filter keeps its own images and needs neither depth nor a pose nor a map. The same frames give the
/// same evidence.
class EpipolarConsistency : public DynamicFilter {
 public:
  EpipolarConsistency(const EpipolarConsistencySettings& settings, const CreationContext& context);

  Needs needs() const override { return {}; }
  void apply(const FilterContext& context, StaticEvidence& evidence) override;

  /// Result of the last frame: the reason why evidence was added or not.
  Verdict verdict() const { return verdict_; }
  const TwoViews& two_views() const { return two_views_; }

 private:
  void choose_features(const Frame& frame);
  void collect_pairs(const Frame& frame, const StaticEvidence& evidence);

  EpipolarConsistencySettings settings_;
  Camera camera_;
  std::uint64_t seed_;
  FeatureFlow flow_;
  TwoViews two_views_;
  Verdict verdict_ = Verdict::few_points;
  std::vector<std::uint32_t> chosen_;   // tracked features
  std::vector<std::uint32_t> places_;   // indices of the pairs in chosen_
  std::vector<std::uint32_t> suspect_;  // indices of pairs far from their line
  PointPairs pairs_;
};

}  // namespace holdfast::epipolar_consistency_plugin
