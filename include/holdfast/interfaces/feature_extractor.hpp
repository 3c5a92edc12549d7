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
  /// The scale pyramid to which Features::octave refers; constant after construction.
  virtual const ScalePyramid& pyramid() const = 0;
};

}  // namespace holdfast
