// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "holdfast/core/features.hpp"
#include "holdfast/optical_flow/point_flow.hpp"

namespace holdfast::epipolar_consistency_plugin {

/// Tracks features into earlier images by follow_points(). Keeps the pyramids of the last images. One thread.
class FeatureFlow {
 public:
  /// `gap` is the number of images that features are tracked back; fewer after an interruption.
  explicit FeatureFlow(int gap) : gap_(static_cast<std::size_t>(gap)) {}

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

  /// See follow(); entry i of each belongs to the i-th chosen feature.
  const std::vector<float>& before_x() const { return flow_.to_x; }
  const std::vector<float>& before_y() const { return flow_.to_y; }
  const std::vector<std::uint8_t>& found() const { return flow_.found; }

 private:
  std::size_t gap_;
  std::deque<ImagePyramid> pyramids_;  // the latest last
  double timestamp_ = 0.0;
  PointFlow flow_, back_;
};

}  // namespace holdfast::epipolar_consistency_plugin
