// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/optical_flow/point_flow.hpp"

namespace holdfast {

/// Follows the features of one image, the template, into the images after it by follow_points(), in place of extracting
/// features there and matching them. Tracking by flow between keyframes is the idea of NGD-SLAM (Zhang et al. 2024).
/// Every image is compared with the template and not with the image before it, so that errors do not add up. Keeps its
/// buffers; one thread.
class FeatureFlow {
 public:
  /// Prepares an image (8UC1) for follow(), and perhaps for set_template() later. Must be called for every image.
  void add_image(const cv::Mat& grey);
  /// Makes the image before the last one the template. `frame` is its frame with final pose and matches: its static
  /// features that show points of the map will be followed.
  void set_template(const Frame& frame);
  /// Gives the template up: nothing is followed until the next one.
  void clear() { points_.clear(); }
  /// Number of features of the template that are followed.
  std::size_t size() const { return points_.size(); }

  /// Finds the template's features in the last image, from where they are predicted, and replaces `features` by those
  /// found, with the octave, angle, response and descriptor that they have in the template. `T_camera_world` is the
  /// predicted pose of the image's camera; none where `ignore` (8UC1, or empty) is not 0. Returns whether enough to
  /// determine a pose were found.
  bool follow(const Eigen::Isometry3d& T_camera_world, const cv::Mat& ignore, Features& features);
  /// The map point that feature i of the last follow() shows in the template; it may have been removed since.
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
