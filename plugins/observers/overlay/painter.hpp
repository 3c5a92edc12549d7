// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/frame_result.hpp"
#include "holdfast/core/sensor_frame.hpp"

namespace holdfast::overlay_plugin {

/// Draws masks, evidence, features and objects of a frame over its colour image. One thread.
class Painter {
 public:
  /// `side_by_side` adds the input image to the left.
  Painter(const Camera& camera, bool side_by_side);

  /// Draws a frame; the result is 8UC3, valid until the next call. Masks are tinted blue (class 1; further classes in
  /// other colours; instances by their ids, which are written on them), unknown cells of a mask are darkened, moving
  /// cells of the coarse view are tinted red. Features are circles from green (static) over yellow to red (moving),
  /// filled if they have a map point. Moving objects have a box and their velocity as an arrow. Below the image is a
  /// line of text.
  const cv::Mat& paint(const SensorFrame& sensor_frame, const Frame& frame, const FrameResult& result);
  cv::Size size() const { return picture_.size(); }

  static constexpr int text_height = 24;  ///< of the line below the image [px]

 private:
  void tint(const cv::Mat& colour, const CoarseView& coarse, cv::Mat& out) const;
  void name_instances(const CoarseView& coarse, cv::Mat& out) const;
  void draw(const MovingObject& object, const FrameResult& result, cv::Mat& out) const;

  Camera camera_;
  CoarseGrid grid_;
  std::vector<std::int32_t> cell_;  // of each raw pixel, -1 = none
  cv::Mat picture_;
};

/// Colour (blue, green, red) of a feature with a static probability.
cv::Scalar feature_colour(float static_probability);
/// "frame 12   4.033 s   tracked   inliers 310   static 801 of 1000".
std::string status_text(const FrameResult& result);
/// "3 person 0.62 m/s".
std::string object_text(const MovingObject& object);

}  // namespace holdfast::overlay_plugin
