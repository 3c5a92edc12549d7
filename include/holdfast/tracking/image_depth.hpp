// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/core/camera.hpp"
#include "holdfast/tracking/depth_provider.hpp"

namespace holdfast {

/// Depth of features by a depth image, and their columns in the virtual right image. Frames without a depth image have
/// no depth. Immutable; any thread.
class ImageDepth final : public DepthProvider {
 public:
  /// edge_ratio: see TrackingSettings::depth_edge_ratio.
  ImageDepth(const Camera& camera, double edge_ratio) : camera_(camera), edge_ratio_(edge_ratio) {}

  void check_images(const SensorFrame& sensor_frame) const override;
  cv::Mat begin(const SensorFrame& sensor_frame, const cv::Mat&) override { return sensor_frame.depth; }
  void read(const SensorFrame& sensor_frame, Frame& frame) override;
  /// A feature with ray r and depth z is visible in the depth image at the projection of
  ///
  ///   T_depth_colour * (z * r)
  ///
  /// and the depth measured there, transformed back to the colour camera, is the new depth. One fixed-point iteration
  /// suffices because the delay is a few milliseconds. A feature without depth is projected at a typical depth, which
  /// does not matter for a rotation.
  void align(const SensorFrame& sensor_frame, const Eigen::Isometry3d& T_depth_colour, Frame& frame) override;

 private:
  float depth_at(const cv::Mat& depth, float x, float y) const;
  void set_depth(std::size_t feature, float depth, Frame& frame) const;

  Camera camera_;
  double edge_ratio_;
};

}  // namespace holdfast
