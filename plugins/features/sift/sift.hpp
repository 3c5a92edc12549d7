// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/features2d.hpp>
#include <vector>

#include "holdfast/core/module.hpp"
#include "holdfast/interfaces/feature_extractor.hpp"
#include "holdfast/settings/sift.hpp"

namespace holdfast::sift_plugin {

/// SIFT (Lowe, "Distinctive image features from scale-invariant keypoints", IJCV 60(2), 2004) by OpenCV: maxima of
/// differences of Gaussians, 128 numbers from 0 to 255. Features of the scale sigma * 2^(k / layers) have octave k.
class SiftExtractor final : public FeatureExtractor {
 public:
  explicit SiftExtractor(const SiftSettings& settings, const CreationContext& context = {});

  void extract(const cv::Mat& grey, const cv::Mat& ignore, Features& out) override;
  const ScalePyramid& pyramid() const override { return pyramid_; }
  DescriptorType descriptor_type() const override { return type_; }

 private:
  ScalePyramid pyramid_;
  DescriptorType type_;
  int octave_layers_;
  cv::Ptr<cv::SIFT> sift_;
  std::vector<cv::KeyPoint> keypoints_;
  cv::Mat descriptors_, mask_;
};

}  // namespace holdfast::sift_plugin
