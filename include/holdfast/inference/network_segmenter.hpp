// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "holdfast/inference/network.hpp"
#include "holdfast/inference/segmentation_output.hpp"
#include "holdfast/interfaces/segmenter.hpp"

namespace holdfast {

/// A network for semantic segmentation as a Segmenter: an image in, labels and confidence of its size out.
class NetworkSegmenter : public Segmenter {
 public:
  /// Loads the network and runs it once, so that whatever does not fit shows before the first frame. `classes` are the
  /// names by channel or label; one called 'unknown' stands for pixels that nobody is sure of. `form.classes` is set
  /// from them. Throws what Network and decode_segmentation() throw.
  NetworkSegmenter(const NetworkOptions& options, OutputForm form, std::vector<std::string> classes,
                   std::vector<std::string> movable);

  const std::vector<std::string>& classes() const override { return classes_; }
  std::vector<std::string> movable() const override { return movable_; }
  Segmentation segment(const SensorFrame& frame) override;

 protected:
  /// The network's output for an image, valid until the next call.
  virtual cv::Mat scores(const cv::Mat& colour) { return network_.run(colour); }
  /// The same for the mirror image of the last one, once after each scores(); valid until the next call.
  cv::Mat mirrored_scores() { return network_.run_mirrored(); }

 private:
  std::vector<std::string> classes_, movable_;
  OutputForm form_;
  Network network_;
  int unknown_label_ = -1;
};

}  // namespace holdfast
