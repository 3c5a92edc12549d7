// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "holdfast/inference/network.hpp"
#include "holdfast/inference/object_layout.hpp"
#include "holdfast/inference/object_masks.hpp"
#include "holdfast/inference/object_output.hpp"
#include "holdfast/interfaces/segmenter.hpp"
#include "object_classes.hpp"

namespace holdfast::onnx_plugin {

/// A Segmenter that runs a network for objects: instances with masks, or boxes, which become masks by depth.
class ObjectSegmenter final : public Segmenter {
 public:
  /// Loads the network and runs it once, so that errors are reported before the first frame: those of Network,
  /// recognise_objects() and decode_objects().
  ObjectSegmenter(const OnnxSettings& settings, const NetworkOptions& options, const OnnxSignature& signature,
                  const ModelMetadata& metadata);

  const std::vector<std::string>& classes() const override { return classes_.names; }
  std::vector<std::string> movable() const override { return classes_.movable; }
  std::string description() const override;
  Segmentation segment(const SensorFrame& frame) override;

 private:
  void recognise(const OnnxSettings& settings, const ModelMetadata& metadata);
  void prepare(const OnnxSettings& settings);
  cv::Size input() const { return {network_.width(), network_.height()}; }
  bool is_movable(std::size_t label) const;
  /// The mask of an object in a rectangle of the frame, of the last run.
  cv::Mat mask_of(const Detection& detection, const SensorFrame& frame, const FramePlace& place,
                  const cv::Rect& pixels) const;

  ObjectClasses classes_;
  Network network_;
  ObjectLayout layout_;
  InputPreparation preparation_;
  std::string colours_;  ///< of the input, for people
  double min_score_ = 0.0, max_overlap_ = 0.0;
  std::filesystem::path model_;
};

}  // namespace holdfast::onnx_plugin
