// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "holdfast/core/module.hpp"
#include "holdfast/core/sensor_frame.hpp"

namespace holdfast {

/// What is where in a colour image.
struct Segmentation {
  cv::Mat labels;      ///< 8UC1 of the frame's size: index into the segmenter's classes(); 255 = unknown
  cv::Mat confidence;  ///< 8UC1 of the same size, 255 = certain; empty means certain everywhere
  bool empty() const { return labels.empty(); }
};

/// Names the class of every pixel. May be slow: the pipeline asks for keyframes only and never waits in tracking.
/// Used by one thread at a time, not necessarily the one that made it.
class Segmenter : public Module {
 public:
  static constexpr const char* kind = "segmenter";

  /// Class names by label, none twice; label 0 is the background. Empty for a segmenter that never finds anything. Does
  /// not change after construction.
  virtual const std::vector<std::string>& classes() const = 0;
  /// Of the classes, those that can move or be moved; empty when the segmenter does not say.
  virtual std::vector<std::string> movable() const { return {}; }
  /// The segmentation of a frame; empty when it has none for this frame (a result, not an error). Throws InputError for
  /// a frame that it cannot use. The frame is not written to, and later calls leave the result as it is. The same
  /// frames in the same order give the same results.
  virtual Segmentation segment(const SensorFrame& frame) = 0;
};

/// Finds nothing: `segmenter: none`, the default.
class NullSegmenter final : public Segmenter {
 public:
  const std::vector<std::string>& classes() const override {
    static const std::vector<std::string> none;
    return none;
  }
  Segmentation segment(const SensorFrame&) override { return {}; }
};

}  // namespace holdfast
