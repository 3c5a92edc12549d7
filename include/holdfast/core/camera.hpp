// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace holdfast {

/// Radial-tangential lens distortion (Brown 1971, in OpenCV's order k1 k2 p1 p2 k3).
struct Distortion {
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;

  bool is_zero() const { return k1 == 0 && k2 == 0 && p1 == 0 && p2 == 0 && k3 == 0; }
  friend bool operator==(const Distortion&, const Distortion&) = default;
};

/// A pinhole camera with lens distortion. Camera frame: x right, y down, z forward [m]. Pixel centres lie at integer
/// coordinates. "Pixel" without a qualifier means an undistorted pixel, that is, the projection by a camera with the
/// same intrinsics and no distortion.
struct Camera {
  std::string name;   ///< empty for a camera that is given by its intrinsics
  int width = 640;    ///< [px]
  int height = 480;   ///< [px]
  double fx = 525.0;  ///< [px]
  double fy = 525.0;  ///< [px]
  double cx = 319.5;  ///< [px]
  double cy = 239.5;  ///< [px]
  Distortion distortion;
  double baseline = 0.08;    ///< of the virtual (or real) stereo pair [m]; about 0.08 m for a Kinect
  double frame_rate = 30.0;  ///< [1/s]

  /// Undistorted pixel of a point in the camera frame; z must be positive.
  Eigen::Vector2d project(const Eigen::Vector3d& point) const {
    const double inverse_z = 1.0 / point.z();
    return {fx * point.x() * inverse_z + cx, fy * point.y() * inverse_z + cy};
  }
  /// The point in the camera frame at an undistorted pixel and a depth [m] along the optical axis.
  Eigen::Vector3d back_project(double x, double y, double depth) const {
    return {(x - cx) / fx * depth, (y - cy) / fy * depth, depth};
  }
  /// Column of the point in the virtual right image: x - fx * baseline / depth (Mur-Artal and Tardos 2017, section
  /// III-A).
  double right_x(double x, double depth) const { return x - fx * baseline / depth; }

  /// Raw image position of an undistorted pixel.
  Eigen::Vector2d distort(const Eigen::Vector2d& pixel) const;
  /// Undistorted pixel of a raw image position, by fixed-point iteration; the error is below 1e-4 px for the cameras of
  /// find_camera().
  Eigen::Vector2d undistort(const Eigen::Vector2d& raw) const;

  friend bool operator==(const Camera&, const Camera&) = default;

  /// Bounding rectangle [minimum, maximum] of the undistorted pixels of the whole image.
  void undistorted_bounds(Eigen::Vector2d& minimum, Eigen::Vector2d& maximum) const;
};

/// Returns the calibration of a camera known by name, or nothing. Names: tum_fr1, tum_fr2, tum_fr3 (TUM RGB-D
/// calibration page), bonn (Bonn RGB-D Dynamic), icl_nuim, kinect2 (960x540).
std::optional<Camera> find_camera(const std::string& name);
/// All names that find_camera() accepts, sorted.
std::vector<std::string> camera_names();

}  // namespace holdfast
