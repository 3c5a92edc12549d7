// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/features2d.hpp>
#include <vector>

#include "holdfast/core/module.hpp"
#include "holdfast/interfaces/feature_extractor.hpp"
#include "holdfast/settings/akaze.hpp"

namespace holdfast::akaze_plugin {

/// AKAZE (Alcantarilla, Nuevo, Bartoli, "Fast explicit diffusion for accelerated features in nonlinear scale spaces",
/// BMVC 2013) by OpenCV: maxima of the Hessian's determinant in a scale space that keeps edges, MLDB of 486 bits.
class AkazeExtractor final : public FeatureExtractor {
 public:
  explicit AkazeExtractor(const AkazeSettings& settings, const CreationContext& context = {});

  void extract(const cv::Mat& grey, const cv::Mat& ignore, Features& out) override;
  void set_budget(double factor) override { budget_ = factor; }
  const ScalePyramid& pyramid() const override { return pyramid_; }
  DescriptorType descriptor_type() const override { return type_; }

 private:
  std::size_t count_;
  double budget_ = 1.0;
  ScalePyramid pyramid_;
  DescriptorType type_;
  cv::Ptr<cv::AKAZE> akaze_;
  std::vector<cv::KeyPoint> keypoints_;
  cv::Mat descriptors_, mask_;
};

}  // namespace holdfast::akaze_plugin
