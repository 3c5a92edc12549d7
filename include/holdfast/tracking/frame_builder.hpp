// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "holdfast/core/coarse_view.hpp"
#include "holdfast/core/frame.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/core/stage_times.hpp"
#include "holdfast/interfaces/feature_extractor.hpp"
#include "holdfast/tracking/depth_reader.hpp"
#include "holdfast/tracking/rolling_shutter.hpp"
#include "holdfast/tracking/stereo_depth.hpp"
#include "holdfast/tracking/undistortion_table.hpp"

namespace holdfast {

/// Computes the Frame of an image: features, undistorted positions, depth, right column, grid. Depth is that of the
/// depth image or of a stereo pair. Reuses its buffers and those of the frame. One thread.
class FrameBuilder {
 public:
  /// The extractor must outlive the builder. depth_edge_ratio: see TrackingSettings.
  FrameBuilder(const Camera& camera, FeatureExtractor& extractor, double depth_edge_ratio);

  /// Computes depth from the right image instead of the depth image. The camera must have no distortion.
  void use_stereo(const StereoParts& parts) { stereo_.emplace(*camera_, parts); }

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
  /// and the rolling shutter for their positions. Has no effect for a stereo pair. Adds to the stage "frame". Reads the
  /// map if features have map points.
  void place_features(const SensorFrame& sensor_frame, const FrameMotion& motion, bool aligns_depth,
                      const RollingShutter& shutter, const Map& map, Frame& frame, StageTimes& times) const;

  /// True if matches indicate that the left and the right image of the last frame are swapped.
  bool is_pair_exchanged(const Frame& frame) { return stereo_ && stereo_->is_exchanged(grey_, grey_right_, frame); }

  /// Multiplies the number of features to extract from the next frame on (FeatureExtractor::set_budget).
  void set_budget(double factor);

  /// The depth image of the stereo pair of the last frame (StereoDepth::depth_image), which is computed at the first
  /// call; the caller must not write to it.
  const cv::Mat& pair_depth();

  const std::shared_ptr<const Camera>& camera() const { return camera_; }
  const CoarseSampler& coarse_sampler() const { return coarse_sampler_; }
  /// Grey image of the last frame (8UC1); valid until the next one.
  const cv::Mat& grey() const { return grey_; }

 private:
  void build_grid(Frame& frame) const;

  std::shared_ptr<const Camera> camera_;
  std::shared_ptr<const ScalePyramid> pyramid_;
  FeatureExtractor& extractor_;
  DepthReader depth_reader_;
  UndistortionTable undistortion_;
  CoarseSampler coarse_sampler_;
  Eigen::Vector2d minimum_, maximum_;
  cv::Mat unusable_;  // 8UC1, not 0 where the camera cannot use the image; empty if it can everywhere
  cv::Mat ignored_;
  std::optional<StereoDepth> stereo_;
  std::optional<cv::Mat> pair_depth_;    // depth image of the last frame, once it was requested
  cv::Mat grey_, grey_right_;            // images of the sensor frame, or the buffers below
  cv::Mat converted_, converted_right_;  // buffers, because images of a sensor frame must not be written to
};

}  // namespace holdfast
