// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <opencv2/core/mat.hpp>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/frame.hpp"

namespace holdfast {

/// Reads the depth of features from a depth image and computes the column in the virtual right image. Immutable; any
/// thread.
class DepthReader {
 public:
  /// edge_ratio: see TrackingSettings::depth_edge_ratio.
  DepthReader(std::shared_ptr<const Camera> camera, double edge_ratio);

  /// Sets frame.depth and frame.right_x at the pixels of the features, without compensation of the colour-depth delay.
  /// `depth`: 32FC1 [m] of the camera's size, or empty.
  void read(const cv::Mat& depth, Frame& frame) const;
  /// Sets them with compensation of the ego-motion T_depth_colour between the exposures of the colour and the depth
  /// image. A feature with ray r and depth z is visible in the depth image at the projection of
  ///
  ///   T_depth_colour * (z * r)
  ///
  /// and the depth measured there, transformed back to the colour camera, is the new depth. One fixed-point iteration
  /// suffices because the delay is a few milliseconds. A feature without depth is projected at a typical depth, which
  /// does not matter for a rotation.
  void align(const cv::Mat& depth, const Eigen::Isometry3d& T_depth_colour, Frame& frame) const;

 private:
  float depth_at(const cv::Mat& depth, float x, float y) const;
  void set_depth(std::size_t feature, float depth, Frame& frame) const;

  std::shared_ptr<const Camera> camera_;
  double edge_ratio_;
};

}  // namespace holdfast
