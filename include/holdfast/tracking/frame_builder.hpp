// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <opencv2/core/mat.hpp>

#include "holdfast/core/coarse_view.hpp"
#include "holdfast/core/frame.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/core/stage_times.hpp"
#include "holdfast/interfaces/feature_extractor.hpp"
#include "holdfast/tracking/depth_provider.hpp"
#include "holdfast/tracking/rolling_shutter.hpp"
#include "holdfast/tracking/undistortion_table.hpp"

namespace holdfast {

/// Computes the Frame of an image: features, undistorted positions, depth, right column, grid. Reuses its buffers and
/// those of the frame. One thread.
class FrameBuilder {
 public:
  /// The extractor and the source of depth must outlive the builder.
  FrameBuilder(const Camera& camera, FeatureExtractor& extractor, DepthProvider& depth);

  /// Throws InputError, with the number of the frame, for images of another type or size than the camera's.
  void check_images(const SensorFrame& sensor_frame) const;

  /// Replaces the content of `frame`; poses and map points are reset. The images must have the camera's size
  /// (InputError otherwise). Adds the stages "features" and "frame".
  void build(const SensorFrame& sensor_frame, Frame& frame, StageTimes& times) {
    begin(sensor_frame, frame, times);
    find_features(sensor_frame, cv::Mat(), frame, times);
  }
  /// First part of build(): everything except features.
  void begin(const SensorFrame& sensor_frame, Frame& frame, StageTimes& times);
  /// Second part of build(): features with their positions and depth. Excluded are pixels where `ignore` (8UC1 of the
  /// image's size, or empty) is not 0, and those that the camera cannot use (Camera::is_usable).
  void find_features(const SensorFrame& sensor_frame, const cv::Mat& ignore, Frame& frame, StageTimes& times);

  /// Second part for a frame whose features are already set, without their extraction. Not for stereo pairs.
  void complete(const SensorFrame& sensor_frame, Frame& frame, StageTimes& times);

  /// Compensates the ego-motion within a frame: the colour-depth delay for the depth of features, if `aligns_depth`,
  /// and the rolling shutter for their positions. Has no effect unless depth allows it. Adds to the stage "frame".
  /// Reads the map if features have map points.
  void place_features(const SensorFrame& sensor_frame, const FrameMotion& motion, bool aligns_depth,
                      const RollingShutter& shutter, const Map& map, Frame& frame, StageTimes& times) const;

  /// Multiplies the number of features to extract from the next frame on (FeatureExtractor::set_budget).
  void set_budget(double factor);

  const std::shared_ptr<const Camera>& camera() const { return camera_; }
  const CoarseSampler& coarse_sampler() const { return coarse_sampler_; }
  /// Grey image of the last frame (8UC1); valid until the next one.
  const cv::Mat& grey() const { return grey_; }

 private:
  void build_grid(Frame& frame) const;

  std::shared_ptr<const Camera> camera_;
  std::shared_ptr<const ScalePyramid> pyramid_;
  FeatureExtractor& extractor_;
  DepthProvider& depth_;
  UndistortionTable undistortion_;
  CoarseSampler coarse_sampler_;
  Eigen::Vector2d minimum_, maximum_;
  cv::Mat unusable_;  // 8UC1, not 0 where the camera cannot use the image; empty if it can everywhere
  cv::Mat ignored_;
  cv::Mat grey_;       // the image of the sensor frame, or the buffer
  cv::Mat converted_;  // buffer, because images of a sensor frame must not be written to
};

}  // namespace holdfast
