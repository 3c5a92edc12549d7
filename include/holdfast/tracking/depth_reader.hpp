// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <opencv2/core/mat.hpp>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/frame.hpp"

namespace holdfast {

/// Reads the depth of features from a depth image, and with it the column in the virtual right image. Immutable; any
/// thread.
class DepthReader {
 public:
  /// edge_ratio: see TrackingSettings::depth_edge_ratio.
  DepthReader(std::shared_ptr<const Camera> camera, double edge_ratio);

  /// Reads frame.depth and frame.right_x at the pixels of the features, as if both images were exposed together.
  /// `depth`: 32FC1 [m] of the camera's size, or empty.
  void read(const cv::Mat& depth, Frame& frame) const;
  /// Reads them again for a camera that moved by T_depth_colour from the exposure of the colour image to that of the
  /// depth image. A feature with ray r, whose depth was z, is seen by the depth image at the projection of
  ///
  ///   T_depth_colour * (z * r)
  ///
  /// and the surface measured there, taken back to the colour image, has the new depth: one step of a fixed-point
  /// iteration, which suffices because the motion is that of a few milliseconds. A feature without depth starts at a
  /// typical depth, which rotation does not need.
  void align(const cv::Mat& depth, const Eigen::Isometry3d& T_depth_colour, Frame& frame) const;

 private:
  float depth_at(const cv::Mat& depth, float x, float y) const;
  void set_depth(std::size_t feature, float depth, Frame& frame) const;

  std::shared_ptr<const Camera> camera_;
  double edge_ratio_;
};

}  // namespace holdfast
