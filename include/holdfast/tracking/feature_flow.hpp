// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/optical_flow/point_flow.hpp"

namespace holdfast {

/// Tracks the features of one image, the template, into later images by optical flow (follow_points()), in place of
/// feature extraction and matching, as NGD-SLAM does between keyframes (Zhang et al. 2024). Every image is compared
/// with the template and not with the previous image, so that errors do not accumulate. Keeps its buffers; one thread.
class FeatureFlow {
 public:
  /// Adds an image (8UC1) for follow() and a later set_template(). Must be called for every image.
  void add_image(const cv::Mat& grey);
  /// Makes the image before the last one the template. `frame` is its frame with final pose and matches; its static
  /// features with map points will be tracked.
  void set_template(const Frame& frame);
  /// Removes the template.
  void clear() { points_.clear(); }
  /// Number of tracked features of the template.
  std::size_t size() const { return points_.size(); }

  /// Tracks the features of the template into the last image, starting at their predicted positions, and replaces
  /// `features` by those found, with octave, angle, response and descriptor of the template. `T_camera_world` is the
  /// predicted pose of the last image. Pixels where `ignore` (8UC1, or empty) is not 0 are excluded. Returns whether
  /// enough features for a pose were found.
  bool follow(const Eigen::Isometry3d& T_camera_world, const cv::Mat& ignore, Features& features);
  /// Map point of each feature of the last follow(); it may have been removed meanwhile.
  const std::vector<MapPointId>& found_points() const { return found_points_; }

 private:
  void predict(const Eigen::Isometry3d& T_camera_template);

  // The template, by followed feature.
  std::shared_ptr<const Camera> camera_;
  Eigen::Isometry3d T_world_template_ = Eigen::Isometry3d::Identity();
  std::vector<MapPointId> points_;
  std::vector<Eigen::Vector3f> rays_;  // to the feature: its position [m] if it has depth, otherwise its direction
  std::vector<std::uint8_t> has_depth_;
  std::vector<float> x_, y_;  // undistorted [px]
  Features features_;
  ImagePyramid template_;

  ImagePyramid image_, last_image_;
  PointFlow flow_;
  std::vector<MapPointId> found_points_;
};

}  // namespace holdfast
