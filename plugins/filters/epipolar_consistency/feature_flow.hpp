// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "holdfast/core/features.hpp"

namespace holdfast::epipolar_consistency_plugin {

/// Tracks features into earlier images by pyramidal Lucas-Kanade (Bouguet, "Pyramidal implementation of the Lucas
/// Kanade feature tracker", 2000) on grey images of half size. Keeps the pyramids of the last images. One thread.
class FeatureFlow {
 public:
  /// `gap` is the number of images that features are tracked back; fewer after an interruption.
  explicit FeatureFlow(int gap) : gap_(static_cast<std::size_t>(gap)) {}

  /// Whether the image is large enough at half size for the compared window.
  static bool can_follow(const cv::Mat& colour);
  /// Adds the image of a frame, 8UC3 or 8UC1. A frame more than 0.25 s after the last one restarts the sequence.
  void add_image(const cv::Mat& colour, double timestamp);
  /// Whether there is an earlier image.
  bool ready() const { return pyramids_.size() > 1; }
  /// Tracks the `chosen` features of the last image into the earliest kept image. Results: before_x, before_y, the raw
  /// positions there [px of the full image], and found, which is 0 if tracking failed, the feature left the image, or
  /// its appearance changed.
  void follow(const Features& features, const std::vector<std::uint32_t>& chosen);
  /// Tracks the features at these indices of `chosen` forward again and marks those that do not return to their origin
  /// as lost.
  void check_back(const std::vector<std::uint32_t>& places);

  std::vector<float> before_x, before_y;
  std::vector<std::uint8_t> found;

 private:
  using Pyramid = std::vector<cv::Mat>;

  std::size_t gap_;
  std::deque<Pyramid> pyramids_;  // the latest last
  double timestamp_ = 0.0;
  cv::Mat half_, grey_;
  std::vector<cv::Point2f> now_, before_, back_from_, back_to_;
  std::vector<std::uint8_t> status_;
  std::vector<float> difference_;
};

}  // namespace holdfast::epipolar_consistency_plugin
