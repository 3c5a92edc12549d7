// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "holdfast/core/module.hpp"
#include "holdfast/core/simd.hpp"
#include "holdfast/interfaces/feature_extractor.hpp"
#include "holdfast/settings/orb.hpp"

namespace holdfast {

/// ORB features, evenly spread (README.md): FAST corners of an image pyramid, orientation by intensity centroid,
/// steered BRIEF of 256 bits. Positions are of the full image, at sub-pixel accuracy; no feature lies within 19 pixels
/// of the border of its level. `response` is the FAST score. At most `count` features, times the budget.
class OrbExtractor : public FeatureExtractor {
 public:
  /// `level` is for tests and benchmarks: all levels give the same bytes.
  explicit OrbExtractor(const OrbSettings& settings = {}, const CreationContext& context = {},
                        SimdLevel level = simd_level());
  ~OrbExtractor() override;

  void extract(const cv::Mat& grey, const cv::Mat& ignore, Features& out) override;
  void set_budget(double factor) override { budget_ = factor; }
  const ScalePyramid& pyramid() const override { return scales_; }

 private:
  struct Work;

  void detect(const cv::Mat& ignore);
  void select();
  void describe(Features& out);

  OrbSettings settings_;
  double budget_ = 1.0;
  ScalePyramid scales_;
  std::unique_ptr<Work> work_;
};

}  // namespace holdfast
