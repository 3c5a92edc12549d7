// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/inference/network_segmenter.hpp"

#include <algorithm>
#include <opencv2/core/mat.hpp>
#include <utility>

#include "holdfast/core/error.hpp"

namespace holdfast {

void check_colour_image(const SensorFrame& frame) {
  if (frame.colour.empty() || frame.colour.type() != CV_8UC3)
    throw InputError({"frame " + std::to_string(frame.index)},
                     "has no colour image for the network; expected 8 bit and three channels");
}

NetworkSegmenter::NetworkSegmenter(const NetworkOptions& options, OutputForm form, std::vector<std::string> classes,
                                   std::vector<std::string> movable)
    : classes_(std::move(classes)),
      movable_(std::move(movable)),
      form_(std::move(form)),
      is_loaded_in_background_(options.in_background),
      network_(options) {
  form_.classes = static_cast<int>(classes_.size());
  form_.input_width = network_.width(), form_.input_height = network_.height();
  check_output_kind(network_.output(), form_);
  const auto unknown = std::find(classes_.begin(), classes_.end(), "unknown");
  if (unknown != classes_.end()) unknown_label_ = static_cast<int>(unknown - classes_.begin());
  if (!is_loaded_in_background_) NetworkSegmenter::finish_loading();
}

void NetworkSegmenter::finish_loading() {
  SensorFrame trial;
  trial.colour = cv::Mat::zeros(network_.height(), network_.width(), CV_8UC3);
  NetworkSegmenter::segment(trial);
}

Segmentation NetworkSegmenter::segment(const SensorFrame& frame) {
  check_colour_image(frame);
  Segmentation result = decode_segmentation(scores(frame.colour), form_, frame.colour.cols, frame.colour.rows);
  if (unknown_label_ >= 0) result.labels.setTo(255, result.labels == unknown_label_);
  return result;
}

}  // namespace holdfast
