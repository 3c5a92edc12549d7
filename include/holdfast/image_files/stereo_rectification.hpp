// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <mutex>
#include <opencv2/core/mat.hpp>

#include "holdfast/core/camera.hpp"

namespace holdfast {

/// Two cameras that take their images at the same time, as calibrated.
struct StereoCameras {
  Camera left;
  Camera right;
  /// Maps points from the frame of the right camera to that of the left one [m]; its translation is the position of the
  /// right camera in the frame of the left one.
  Eigen::Isometry3d T_left_right = Eigen::Isometry3d::Identity();
};

/// Rectification of the images of a stereo pair, as SensorFrame needs them: both cameras are turned on the spot until
/// their rows lie on the line between them and their optical axes are parallel (Fusiello, Trucco, Verri: A compact
/// algorithm for rectification of stereo pairs, Machine Vision and Applications 2000; the new axis is the mean of the
/// two old ones), and both images are warped to one camera without distortion, whose image shows nothing that one of
/// the two did not see. Of a fisheye lens, Camera::usable_angle bounds the image. Immutable after construction; any
/// thread.
class StereoRectification {
 public:
  /// Throws Error if one of the cameras has trouble (Camera::trouble), if the right camera is not to the right of the
  /// left one, or if they look at different places.
  explicit StereoRectification(const StereoCameras& calibration);

  const StereoCameras& calibration() const { return calibration_; }
  /// The camera of both rectified images: the size and the frame rate of the left one, no distortion; `baseline` is the
  /// distance of the cameras.
  const Camera& camera() const { return camera_; }
  /// Maps points from the frame of the rectified left camera to that of the left camera; a rotation.
  const Eigen::Isometry3d& T_left_rectified() const { return T_left_rectified_; }
  /// The same for the right camera.
  const Eigen::Isometry3d& T_right_rectified() const { return T_right_rectified_; }

  /// The rectified image of a raw one of the size of its camera, of any type, by bilinear interpolation.
  cv::Mat rectify_left(const cv::Mat& raw) const;
  cv::Mat rectify_right(const cv::Mat& raw) const;

 private:
  struct Maps {
    cv::Mat whole, fraction;  // as of cv::convertMaps
  };
  Maps maps_of(const Camera& raw, const Eigen::Isometry3d& T_raw_rectified) const;
  cv::Mat rectify(const cv::Mat& raw, const Camera& camera, const Eigen::Isometry3d& T_raw_rectified,
                  std::once_flag& once, Maps& maps) const;

  StereoCameras calibration_;
  Eigen::Isometry3d T_left_rectified_, T_right_rectified_;
  Camera camera_;
  // Made with the first image: only then is it sure that images are as large as a calibration says.
  mutable std::once_flag left_once_, right_once_;
  mutable Maps left_, right_;
};

}  // namespace holdfast
