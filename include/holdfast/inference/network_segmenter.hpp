// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "holdfast/inference/network.hpp"
#include "holdfast/inference/segmentation_output.hpp"
#include "holdfast/interfaces/segmenter.hpp"

namespace holdfast {

/// Throws InputError for a frame whose colour image is not one of 8 bit and three channels, as networks take it.
void check_colour_image(const SensorFrame& frame);

/// A Segmenter that runs a semantic segmentation network and decodes its output to labels and confidence.
class NetworkSegmenter : public Segmenter {
 public:
  /// Loads the network and runs it once, so that errors are reported before the first frame; with
  /// NetworkOptions::in_background it begins to load, and finish_loading() or the first frame waits. `classes` are the
  /// names by channel or label; the name 'unknown' denotes unlabelled pixels. `form.classes` is set from them. Throws
  /// the exceptions of Network and decode_segmentation().
  NetworkSegmenter(const NetworkOptions& options, OutputForm form, std::vector<std::string> classes,
                   std::vector<std::string> movable);

  const std::vector<std::string>& classes() const override { return classes_; }
  std::vector<std::string> movable() const override { return movable_; }
  bool first_call_waits() const override { return is_loaded_in_background_; }
  /// Waits for the network and runs it once, with the errors of the constructor.
  void finish_loading() override;
  Segmentation segment(const SensorFrame& frame) override;

 protected:
  /// Size of the network's input [px].
  cv::Size input_size() const { return {network_.width(), network_.height()}; }
  /// What computes the network, for people.
  std::string engine_text() const { return network_.engine_text(); }
  /// Computes the network's output for an image, valid until the next call.
  virtual cv::Mat scores(const cv::Mat& colour) { return network_.run(colour); }
  /// Computes the output for the mirror image of the last image, at most once after each scores(); valid until the next
  /// call.
  cv::Mat mirrored_scores() { return network_.run_mirrored(); }

 private:
  std::vector<std::string> classes_, movable_;
  OutputForm form_;
  bool is_loaded_in_background_;
  Network network_;
  int unknown_label_ = -1;
};

}  // namespace holdfast
