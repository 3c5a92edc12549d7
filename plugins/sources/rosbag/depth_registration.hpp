// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "holdfast/core/camera.hpp"

namespace holdfast::rosbag_plugin {

/// Moves depth images into the view of a colour camera: each pixel of depth becomes the rectangle of colour pixels that
/// its corners project to, so that no gaps arise where colour has more pixels, and of several depths the nearest stays.
/// Used by one thread.
class DepthRegistration {
 public:
  /// `T_colour_depth` maps points of the depth camera to the colour camera [m].
  DepthRegistration(const Camera& depth, const Camera& colour, const Eigen::Isometry3d& T_colour_depth);

  cv::Size depth_size() const { return {depth_.width, depth_.height}; }
  /// Depth along the optical axis of the colour camera, 32FC1 [m], 0 = no value, for 32FC1 of depth_size().
  cv::Mat apply(const cv::Mat& depth) const;

 private:
  /// Pixel of the raw colour image; nothing behind the camera.
  bool project(const Eigen::Vector3d& point, Eigen::Vector2d& pixel) const;

  Camera depth_, colour_;
  Eigen::Isometry3d T_colour_depth_;
  std::vector<Eigen::Vector3d> corners_;  ///< rays of the corners of the depth pixels, z = 1, in the colour frame
};

}  // namespace holdfast::rosbag_plugin
