// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/imgproc.hpp>

#include "holdfast/image_files/stereo_rectification.hpp"

namespace holdfast::test {

/// Cameras of a pair with distortion, each turned by some degrees, that see parts of what a rectified pair of rendered
/// cameras sees; warps the images of the latter.
class RawPair {
 public:
  /// `rendered`: its baseline is that of the pair. Both raw cameras have the numbers of `raw`, the right one a
  /// principal point of its own.
  RawPair(const Camera& rendered, const Camera& raw) : rendered_(rendered) {
    calibration_.left = calibration_.right = raw;
    calibration_.right.cx += 7.0, calibration_.right.cy -= 5.0;
    T_rendered_left_ = rotation(1.0, -2.0, 1.5);
    Eigen::Isometry3d T_rendered_right = rotation(-1.5, 1.0, -2.0);
    T_rendered_right.translation().x() = rendered.baseline;
    calibration_.T_left_right = T_rendered_left_.inverse() * T_rendered_right;
    left_map_ = map_of(calibration_.left, T_rendered_left_.linear());
    right_map_ = map_of(calibration_.right, T_rendered_right.linear());
  }

  const StereoCameras& calibration() const { return calibration_; }
  const Eigen::Isometry3d& T_rendered_left() const { return T_rendered_left_; }
  cv::Mat left(const cv::Mat& rendered) const { return warped(rendered, left_map_); }
  cv::Mat right(const cv::Mat& rendered) const { return warped(rendered, right_map_); }

 private:
  static Eigen::Isometry3d rotation(double x, double y, double z) {  // degrees
    constexpr double degree = 3.14159265358979323846 / 180.0;
    return Eigen::Isometry3d(Eigen::AngleAxisd(x * degree, Eigen::Vector3d::UnitX()) *
                             Eigen::AngleAxisd(y * degree, Eigen::Vector3d::UnitY()) *
                             Eigen::AngleAxisd(z * degree, Eigen::Vector3d::UnitZ()));
  }
  cv::Mat map_of(const Camera& raw, const Eigen::Matrix3d& R_rendered_raw) const {
    cv::Mat map(raw.height, raw.width, CV_32FC2);
    for (int row = 0; row < map.rows; ++row)
      for (int column = 0; column < map.cols; ++column) {
        const Eigen::Vector2d pixel = raw.undistort({column, row});
        const Eigen::Vector2d there = rendered_.project(R_rendered_raw * raw.back_project(pixel.x(), pixel.y(), 1.0));
        map.at<cv::Vec2f>(row, column) = {static_cast<float>(there.x()), static_cast<float>(there.y())};
      }
    return map;
  }
  static cv::Mat warped(const cv::Mat& rendered, const cv::Mat& map) {
    cv::Mat raw;
    cv::remap(rendered, raw, map, cv::noArray(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
    return raw;
  }

  Camera rendered_;
  StereoCameras calibration_;
  Eigen::Isometry3d T_rendered_left_;
  cv::Mat left_map_, right_map_;
};

/// A lens like that of EuRoC's cameras.
inline Camera barrel_camera() {
  Camera camera;
  camera.width = 600, camera.height = 400;
  camera.fx = 400, camera.fy = 399, camera.cx = 295, camera.cy = 203;
  camera.distortion = {-0.283, 0.074, 0.0002, 0.00002, 0.0};
  return camera;
}

/// A fisheye lens of the same view.
inline Camera fisheye_camera() {
  Camera camera = barrel_camera();
  camera.distortion = {.k1 = -0.01, .k2 = 0.02, .k3 = -0.01, .k4 = 0.002};
  camera.distortion.lens = Lens::fisheye;
  return camera;
}

}  // namespace holdfast::test
