// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "holdfast/core/features.hpp"
#include "holdfast/core/module.hpp"
#include "holdfast/core/scale_pyramid.hpp"

namespace holdfast {

/// Detects and describes features. Used by one thread at a time; implementations may keep buffers between images.
class FeatureExtractor : public Module {
 public:
  static constexpr const char* kind = "features";

  /// Extracts features from a grey image (8UC1, any size); an empty image or one too small for a feature gives none.
  /// `ignore` is empty or 8UC1 of the same size; no features are extracted where it is not 0, with a tolerance of two
  /// pixels of the feature's octave. Neither image is written to. `out` is replaced. The same image gives the same
  /// features in the same order, on every call and at every SIMD level.
  virtual void extract(const cv::Mat& grey, const cv::Mat& ignore, Features& out) = 0;
  /// Multiplies the configured number of features by `factor` (at least 1) from the next image on, to compensate for
  /// features on moving people. An extractor without such a number ignores it. The same image with the same budget
  /// gives the same features.
  virtual void set_budget(double factor) { static_cast<void>(factor); }
  /// The scale pyramid to which Features::octave refers; constant after construction. An extractor without octaves has
  /// a pyramid of one level.
  virtual const ScalePyramid& pyramid() const = 0;
  /// The type of all descriptors that extract() returns, with the distances that this extractor recommends; constant
  /// after construction. Unless overridden: 256 bits, with the distances of ORB-SLAM2.
  virtual DescriptorType descriptor_type() const { return {}; }
  /// Whether Features::angle is the orientation of a feature, which turns with the image. Otherwise all angles are 0.
  virtual bool has_angles() const { return true; }
};

}  // namespace holdfast
