// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "feature_flow.hpp"
#include "holdfast/core/random.hpp"
#include "holdfast/interfaces/dynamic_filter.hpp"
#include "holdfast/settings/epipolar_consistency.hpp"
#include "two_views.hpp"

namespace holdfast::epipolar_plugin {

/// Moving consistency check after DS-SLAM (Yu, Liu, Liu, Xie, Yang, Wei, Fei: DS-SLAM, IROS 2018, section II-C):
/// features are followed between two images, a fundamental matrix is found by RANSAC, and a feature whose distance from
/// its epipolar line exceeds a threshold moves. Beyond the paper: features that are already known to be suspect
/// (static_probability below 0.5, or negative evidence of filters before this one) do not take part in the estimate,
/// and where epipolar lines mean nothing (Verdict) nothing is said at all. Statements are measurements. Keeps images of
/// its own, so it needs neither depth nor a pose nor a map. Same frames, same evidence.
class EpipolarConsistency : public DynamicFilter {
 public:
  EpipolarConsistency(const EpipolarConsistencySettings& settings, const CreationContext& context);

  Needs needs() const override { return {}; }
  void apply(const FilterContext& context, StaticEvidence& evidence) override;

  /// Of the last frame: why it said something or nothing.
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
  std::vector<std::uint32_t> chosen_;   // features that are followed
  std::vector<std::uint32_t> places_;   // of the pairs in chosen_
  std::vector<std::uint32_t> suspect_;  // places of those far from their line
  PointPairs pairs_;
};

}  // namespace holdfast::epipolar_plugin
