// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include <opencv2/core/types.hpp>

#include "holdfast/core/module.hpp"
#include "holdfast/interfaces/feature_extractor.hpp"
#include "holdfast/settings/opencv_orb.hpp"

namespace cv {
class ORB;
}

namespace holdfast::opencv_orb_plugin {

/// OpenCV's ORB (Rublee et al., ICCV 2011) behind our interface: features by Harris response over the whole image, with
/// no care for an even spread. A yardstick, and the proof that extractors can be swapped. `count` may be exceeded by
/// features whose response equals the weakest that was kept. Features keep OpenCV's border of 31 pixels of their level.
class OpencvOrb : public FeatureExtractor {
 public:
  explicit OpencvOrb(const OpencvOrbSettings& settings, const CreationContext& context = {});
  ~OpencvOrb() override;

  void extract(const cv::Mat& grey, const cv::Mat& ignore, Features& out) override;
  void set_budget(double factor) override;
  const ScalePyramid& pyramid() const override { return pyramid_; }

 private:
  /// Levels on which the image is still large enough for a feature; OpenCV fails on levels that vanish.
  int usable_levels(const cv::Mat& grey) const;

  int count_;
  ScalePyramid pyramid_;
  std::unique_ptr<cv::Ptr<cv::ORB>> orb_;
  std::vector<cv::KeyPoint> keypoints_;
  cv::Mat descriptors_, mask_;
};

}  // namespace holdfast::opencv_orb_plugin
