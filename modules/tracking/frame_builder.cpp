// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/frame_builder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <string>

#include "holdfast/core/error.hpp"

namespace holdfast {

FrameBuilder::FrameBuilder(const Camera& camera, FeatureExtractor& extractor, double depth_edge_ratio)
    : camera_(std::make_shared<const Camera>(camera)),
      pyramid_(std::make_shared<const ScalePyramid>(extractor.pyramid())),
      extractor_(extractor),
      depth_edge_ratio_(depth_edge_ratio),
      undistortion_(camera),
      coarse_sampler_(camera) {
  camera.undistorted_bounds(minimum_, maximum_);
}

void FrameBuilder::begin(const SensorFrame& sensor_frame, Frame& frame, StageTimes& times) {
  const cv::Mat& colour = sensor_frame.colour;
  const auto size_text = [](int width, int height) { return std::to_string(width) + "x" + std::to_string(height); };
  if (colour.type() != CV_8UC3 || colour.cols != camera_->width || colour.rows != camera_->height)
    throw InputError({"frame " + std::to_string(sensor_frame.index)},
                     "the colour image is " + size_text(colour.cols, colour.rows) + " with " +
                         std::to_string(colour.channels()) + " channels; expected " +
                         size_text(camera_->width, camera_->height) + " with 3 channels of 8 bit, as the camera says");
  const cv::Mat& depth = sensor_frame.depth;
  if (!depth.empty() && (depth.type() != CV_32FC1 || depth.size() != colour.size()))
    throw InputError({"frame " + std::to_string(sensor_frame.index)},
                     "the depth image is " + size_text(depth.cols, depth.rows) +
                         "; expected one 32 bit float channel [m] of the colour image's size");
  const StageTimer timer(times, "frame");
  frame.index = sensor_frame.index;
  frame.timestamp = sensor_frame.timestamp;
  frame.camera = camera_;
  frame.pyramid = pyramid_;
  frame.T_camera_world.setIdentity();
  cv::cvtColor(colour, grey_, cv::COLOR_BGR2GRAY);
  coarse_sampler_.sample_depth(depth, frame.coarse);
}

void FrameBuilder::find_features(const SensorFrame& sensor_frame, const cv::Mat& ignore, Frame& frame,
                                 StageTimes& times) {
  {
    const StageTimer timer(times, "features");
    extractor_.extract(grey_, ignore, frame.features);
  }
  const StageTimer timer(times, "frame");
  undistortion_.undistort(frame.features.x, frame.features.y, frame.x, frame.y);
  read_depth(sensor_frame.depth, frame);
  frame.map_points.assign(frame.size(), MapPointId());
  frame.static_probability.assign(frame.size(), 1.0F);
  frame.measured_log_odds.assign(frame.size(), 0.0F);
  frame.grid.build(frame.x, frame.y,
                   {static_cast<float>(minimum_.x()), static_cast<float>(minimum_.y()),
                    static_cast<float>(maximum_.x()), static_cast<float>(maximum_.y())});
}

void FrameBuilder::read_depth(const cv::Mat& depth, Frame& frame) const {
  const std::size_t count = frame.size();
  frame.depth.assign(count, 0.0F);
  frame.right_x.assign(count, std::numeric_limits<float>::quiet_NaN());
  if (depth.empty()) return;
  const float fx_baseline = static_cast<float>(camera_->fx * camera_->baseline);
  for (std::size_t i = 0; i < count; ++i) {
    const int column = std::clamp(static_cast<int>(frame.features.x[i] + 0.5F), 0, depth.cols - 1);
    const int row = std::clamp(static_cast<int>(frame.features.y[i] + 0.5F), 0, depth.rows - 1);
    const float value = depth.at<float>(row, column);
    if (!(value > 0.0F) || !std::isfinite(value)) continue;
    if (depth_edge_ratio_ > 0.0) {
      // At an edge of depth the feature may lie on either side: its depth would be a guess.
      float nearest = value, farthest = value;
      constexpr int reach = 2;
      for (int r = std::max(row - reach, 0); r <= std::min(row + reach, depth.rows - 1); r += reach)
        for (int c = std::max(column - reach, 0); c <= std::min(column + reach, depth.cols - 1); c += reach) {
          const float neighbour = depth.at<float>(r, c);
          if (!(neighbour > 0.0F)) continue;
          nearest = std::min(nearest, neighbour);
          farthest = std::max(farthest, neighbour);
        }
      if (farthest - nearest > depth_edge_ratio_ * value) continue;
    }
    frame.depth[i] = value;
    frame.right_x[i] = frame.x[i] - fx_baseline / value;
  }
}

}  // namespace holdfast
