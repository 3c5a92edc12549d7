// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "holdfast/core/features.hpp"

namespace holdfast::epipolar_plugin {

/// Follows features into earlier images by pyramidal Lucas-Kanade (Bouguet, "Pyramidal implementation of the Lucas
/// Kanade feature tracker", 2000) on grey images of half size. Keeps the pyramids of the last images. One thread.
class FeatureFlow {
 public:
  /// gap: how many images back features are followed; after a break as far as there are images.
  explicit FeatureFlow(int gap) : gap_(static_cast<std::size_t>(gap)) {}

  /// Whether half of such an image holds the window that is compared.
  static bool can_follow(const cv::Mat& colour);
  /// Takes a frame's image, 8UC3 or 8UC1. A frame that comes more than 0.25 s after the last one begins anew.
  void add_image(const cv::Mat& colour, double timestamp);
  /// Whether there is an earlier image to follow features into.
  bool ready() const { return pyramids_.size() > 1; }
  /// Follows `chosen` features of the last image into the earliest one kept. before_x, before_y: raw positions there
  /// [px of the full image]; found: 0 where the way was lost, left the image, or looks different at its end.
  void follow(const Features& features, const std::vector<std::uint32_t>& chosen);
  /// Of the features at these places in `chosen`, marks as lost those that do not come back to where they started.
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

}  // namespace holdfast::epipolar_plugin
