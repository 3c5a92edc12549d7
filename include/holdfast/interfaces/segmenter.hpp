// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "holdfast/core/module.hpp"
#include "holdfast/core/sensor_frame.hpp"

namespace holdfast {

/// One object that a segmenter found in an image, such as one of several people.
struct Instance {
  std::uint8_t label = 0;  ///< index into Segmenter::classes()
  float score = 0.0F;      ///< the network's score, 0 to 1
  cv::Rect2f box;          ///< bounding box [px], within the frame
};

/// Per-pixel semantic segmentation of a colour image, with instances if the segmenter separates them.
struct Segmentation {
  cv::Mat labels;      ///< 8UC1 of the frame's size: index into Segmenter::classes(); 255 = unknown
  cv::Mat confidence;  ///< 8UC1 of the same size, 255 = certain; empty means certain everywhere
  /// 16UC1 of the same size: 0 = no instance, k = found[k - 1]. Empty for a semantic segmentation. Where instances
  /// overlap, a pixel belongs to one of them, so that an instance may have no pixel.
  cv::Mat instances = {};
  std::vector<Instance> found = {};  ///< by decreasing score; empty without `instances`
  bool empty() const { return labels.empty(); }
};

/// Assigns a class to every pixel. It may be slow: the pipeline segments keyframes (or every n-th frame) only, and in
/// threaded mode tracking never waits for the result. Used by one thread at a time, which may differ from the thread
/// that constructed it.
class Segmenter : public Module {
 public:
  static constexpr const char* kind = "segmenter";

  /// Class names by label, without duplicates; label 0 is the background. Empty for a segmenter without classes.
  /// Constant after construction.
  virtual const std::vector<std::string>& classes() const = 0;
  /// The subset of classes() whose members can move or be moved; empty if the segmenter does not specify it.
  virtual std::vector<std::string> movable() const { return {}; }
  /// Description of the loaded network for users, in whole sentences: kind, input, classes, thresholds. Printed by
  /// `holdfast check`; may be empty.
  virtual std::string description() const { return {}; }
  /// Whether the first call of segment() may have to wait for work that the constructor began in another thread, such
  /// as loading weights. Sequential mode then makes this call in another thread, which does not change results.
  /// Constant after construction.
  virtual bool first_call_waits() const { return false; }
  /// Waits for that work. Throws what the first call of segment() would throw because of it. Not while segment() runs.
  virtual void finish_loading() {}
  /// Segments a frame. An empty result means that there is no segmentation for this frame, which is not an error.
  /// Throws InputError for a frame that it cannot use. The frame is not written to, and later calls do not modify an
  /// earlier result. The same frames in the same order give the same results.
  virtual Segmentation segment(const SensorFrame& frame) = 0;
};

/// Null object without classes: `segmenter: none`, the default.
class NullSegmenter final : public Segmenter {
 public:
  const std::vector<std::string>& classes() const override {
    static const std::vector<std::string> none;
    return none;
  }
  Segmentation segment(const SensorFrame&) override { return {}; }
};

}  // namespace holdfast
