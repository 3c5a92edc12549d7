// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/stereo_rectification.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>

#include "holdfast/core/error.hpp"

namespace holdfast {

namespace {

/// A rectangle in the plane z = 1 of the rectified cameras.
struct PlaneBounds {
  double left, right, top, bottom;
};

/// Shrinks the bounds to what a camera sees: each side of its image bounds the side of the rectangle.
void shrink(PlaneBounds& bounds, const Camera& camera, const Eigen::Matrix3d& R_rectified_raw) {
  const auto in_plane = [&](double x, double y) -> Eigen::Vector2d {
    const Eigen::Vector2d pixel = camera.undistort({x, y});
    const Eigen::Vector3d ray = R_rectified_raw * camera.back_project(pixel.x(), pixel.y(), 1.0);
    constexpr double least = 0.05;  // beside or behind the rectified camera: far outside of its image
    return (ray / std::max(ray.z(), least)).head<2>();
  };
  const double last_column = camera.width - 1.0, last_row = camera.height - 1.0;
  constexpr int steps = 64;
  for (int i = 0; i <= steps; ++i) {
    const double share = static_cast<double>(i) / steps;
    bounds.left = std::max(bounds.left, in_plane(0.0, share * last_row).x());
    bounds.right = std::min(bounds.right, in_plane(last_column, share * last_row).x());
    bounds.top = std::max(bounds.top, in_plane(share * last_column, 0.0).y());
    bounds.bottom = std::min(bounds.bottom, in_plane(share * last_column, last_row).y());
  }
}

std::string text(const Eigen::Vector3d& v) {
  return "(" + std::to_string(v.x()) + ", " + std::to_string(v.y()) + ", " + std::to_string(v.z()) + ")";
}

}  // namespace

StereoRectification::StereoRectification(const StereoCameras& calibration) : calibration_(calibration) {
  for (const auto& [name, camera] : {std::pair("left", &calibration.left), std::pair("right", &calibration.right)})
    if (const std::string trouble = camera->trouble(); !trouble.empty())
      throw Error("the " + std::string(name) + " camera cannot be rectified: " + trouble);
  const Eigen::Matrix3d R_left_right = calibration.T_left_right.linear();
  const Eigen::Vector3d position = calibration.T_left_right.translation();
  if (!(position.x() > std::abs(position.y()) && position.x() > std::abs(position.z())))
    throw Error("the right camera is at " + text(position) +
                " m in the frame of the left one (x right, y down, z forward); expected it to the right; exchange the "
                "cameras, or invert their relative pose");
  const Eigen::Vector3d axis_sum = Eigen::Vector3d::UnitZ() + R_left_right.col(2);
  const Eigen::Vector3d x = position.normalized();
  const Eigen::Vector3d y = axis_sum.cross(x).normalized();
  Eigen::Matrix3d R_left_rectified;
  R_left_rectified << x, y, x.cross(y);
  T_left_rectified_ = R_left_rectified;
  T_right_rectified_ = Eigen::Matrix3d(R_left_right.transpose() * R_left_rectified);

  const double widest = std::tan(Camera::usable_angle);
  const bool is_fisheye =
      calibration.left.distortion.lens == Lens::fisheye || calibration.right.distortion.lens == Lens::fisheye;
  const double limit = is_fisheye ? widest : 100.0;
  PlaneBounds bounds{-limit, limit, -limit, limit};
  shrink(bounds, calibration.left, T_left_rectified_.linear().transpose());
  shrink(bounds, calibration.right, T_right_rectified_.linear().transpose());
  constexpr double least_extent = 0.1;
  if (!(bounds.right - bounds.left > least_extent && bounds.bottom - bounds.top > least_extent))
    throw Error(
        "the two cameras have no part of their images in common; expected a pair that looks in one direction; "
        "check their relative pose and their distortion");

  camera_ = calibration.left;
  camera_.name.clear();
  camera_.distortion = {};
  camera_.baseline = position.norm();
  const double focal_length = std::max((camera_.width - 1.0) / (bounds.right - bounds.left),
                                       (camera_.height - 1.0) / (bounds.bottom - bounds.top));
  camera_.fx = camera_.fy = focal_length;
  camera_.cx = 0.5 * (camera_.width - 1.0 - focal_length * (bounds.left + bounds.right));
  camera_.cy = 0.5 * (camera_.height - 1.0 - focal_length * (bounds.top + bounds.bottom));
}

StereoRectification::Maps StereoRectification::maps_of(const Camera& raw,
                                                       const Eigen::Isometry3d& T_raw_rectified) const {
  cv::Mat map(camera_.height, camera_.width, CV_32FC2);
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.cols; ++column) {
      const Eigen::Vector3d ray = T_raw_rectified.linear() * camera_.back_project(column, row, 1.0);
      const Eigen::Vector2d pixel = ray.z() > 1e-3 ? raw.distort(raw.project(ray)) : Eigen::Vector2d(-10.0, -10.0);
      map.ptr<cv::Vec2f>(row)[column] = {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
    }
  Maps maps;
  cv::convertMaps(map, cv::noArray(), maps.whole, maps.fraction, CV_16SC2);
  return maps;
}

cv::Mat StereoRectification::rectify(const cv::Mat& raw, const Camera& camera, const Eigen::Isometry3d& T_raw_rectified,
                                     std::once_flag& once, Maps& maps) const {
  HOLDFAST_CHECK(raw.cols == camera.width && raw.rows == camera.height, raw.cols << "x" << raw.rows);
  std::call_once(once, [&] { maps = maps_of(camera, T_raw_rectified); });
  cv::Mat rectified;
  cv::remap(raw, rectified, maps.whole, maps.fraction, cv::INTER_LINEAR);
  return rectified;
}

cv::Mat StereoRectification::rectify_left(const cv::Mat& raw) const {
  return rectify(raw, calibration_.left, T_left_rectified_, left_once_, left_);
}

cv::Mat StereoRectification::rectify_right(const cv::Mat& raw) const {
  return rectify(raw, calibration_.right, T_right_rectified_, right_once_, right_);
}

}  // namespace holdfast
