// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "holdfast/core/features.hpp"
#include "holdfast/core/module.hpp"
#include "holdfast/core/scale_pyramid.hpp"

namespace holdfast {

/// Finds and describes features. Used by one thread at a time; keeps buffers from image to image.
class FeatureExtractor : public Module {
 public:
  static constexpr const char* kind = "features";

  /// Finds features in a grey image (8UC1, any size; an image too small for a feature, or an empty one, gives none).
  /// `ignore` is empty or 8UC1 of the same size; features are not taken where it is not 0, to within two pixels of
  /// their octave. Neither image is written to. `out` is replaced. The same image gives the same features, in the same
  /// order, on every call and at every SIMD level.
  virtual void extract(const cv::Mat& grey, const cv::Mat& ignore, Features& out) = 0;
  /// The scales of Features::octave; does not change after construction.
  virtual const ScalePyramid& pyramid() const = 0;
};

}  // namespace holdfast
