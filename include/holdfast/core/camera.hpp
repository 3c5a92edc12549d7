// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/core/build_layout.hpp"
#include "holdfast/core/pinhole.hpp"

namespace holdfast {

/// Lens model of the coefficients of a Distortion.
enum class Lens {
  /// Radial and tangential distortion in the image plane (Brown 1971), with a rational radial factor where k4, k5 or k6
  /// is not zero (Claus and Fitzgibbon 2005): cv::undistortPoints with 5 or 8 coefficients.
  radial_tangential,
  /// The distance from the principal point is a polynomial of the angle to the optical axis (Kannala and Brandt 2006,
  /// equation 6 up to the 9th power): cv::fisheye with the coefficients k1, k2, k3, k4.
  fisheye,
};

/// radial_tangential or fisheye.
const char* lens_name(Lens lens);
/// The lens of that name, or nothing.
std::optional<Lens> find_lens(const std::string& name);
/// All names, in the order of Lens.
const std::vector<std::string>& lens_names();

/// Distortion by a lens. With x, y = the undistorted position in the plane z = 1, r^2 = x^2 + y^2:
///
/// radial_tangential: f = (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6);
/// x' = x f + 2 p1 x y + p2 (r^2 + 2 x^2), y' = y f + p1 (r^2 + 2 y^2) + 2 p2 x y.
///
/// fisheye: t = atan(r); x', y' = (x, y) / r * (t + k1 t^3 + k2 t^5 + k3 t^7 + k4 t^9); p1, p2, k5 and k6 must be zero.
struct Distortion {
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;
  double k4 = 0, k5 = 0, k6 = 0;
  Lens lens = Lens::radial_tangential;

  /// True without distortion; never true for a fisheye lens.
  bool is_zero() const {
    return lens == Lens::radial_tangential && k1 == 0 && k2 == 0 && p1 == 0 && p2 == 0 && k3 == 0 && !is_rational();
  }
  bool is_rational() const { return lens == Lens::radial_tangential && (k4 != 0 || k5 != 0 || k6 != 0); }
  /// In OpenCV's order: k1 k2 p1 p2 k3, followed by k4 k5 k6 where these are used; k1 k2 k3 k4 of a fisheye lens.
  std::vector<double> coefficients() const;
  /// Describes an invalid coefficient, such as one that the lens model does not have; empty if all are valid.
  /// Camera::trouble() also checks the distortion over the image.
  std::string trouble() const;
  friend bool operator==(const Distortion&, const Distortion&) = default;
};

/// A pinhole camera with lens distortion. Camera frame: x right, y down, z forward [m]. Pixel centres lie at integer
/// coordinates. "Pixel" without a qualifier means an undistorted pixel, that is, the projection by a camera with the
/// same intrinsics and no distortion.
///
/// Fisheye pixels more than Camera::usable_angle from the optical axis cannot be represented by the pinhole model,
/// whose image plane ends at 90 degrees, and are ignored.
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
  /// Readout time of a rolling shutter [s], from the exposure of the first row to that of the last; 0 = all rows at
  /// once, below 0 = the last row first. The time stamp of an image is that of its middle row.
  double readout = 0.0;

  /// The camera without its distortion, whose pixels are the undistorted ones.
  Pinhole pinhole() const { return {fx, fy, cx, cy, baseline}; }
  /// Functions of pinhole(), for undistorted pixels.
  /// @{
  Eigen::Vector2d project(const Eigen::Vector3d& point) const { return pinhole().project(point); }
  Eigen::Vector2d normalised(double x, double y) const { return pinhole().normalised(x, y); }
  Eigen::Vector3d back_project(double x, double y, double depth) const { return pinhole().back_project(x, y, depth); }
  double right_x(double x, double depth) const { return pinhole().right_x(x, depth); }
  /// @}

  /// Angle to the optical axis up to which the image of a fisheye lens is used [rad]: 60 degrees, where a pixel of the
  /// image is stretched fourfold.
  static constexpr double usable_angle = 1.0471975511965976;

  /// Raw image position of an undistorted pixel.
  Eigen::Vector2d distort(const Eigen::Vector2d& pixel) const;
  /// Undistorted pixel of a raw image position, by fixed-point iteration and, where that does not converge, by Newton
  /// steps from the principal point; the error is below 1e-3 px for a camera without trouble(). Beyond 65 degrees from
  /// the axis of a fisheye lens, the pixel at 65 degrees in the same direction.
  Eigen::Vector2d undistort(const Eigen::Vector2d& raw) const;
  /// False for a raw image position of a fisheye lens that lies beyond usable_angle; true otherwise.
  bool is_usable(const Eigen::Vector2d& raw) const;

  friend bool operator==(const Camera&, const Camera&) = default;

  /// Describes why the camera cannot be used: invalid intrinsics, a coefficient that the lens model does not have, or a
  /// distortion without an inverse in the image. Empty if the camera is valid. The inverse is continued from the
  /// principal point to the border of the image, where the Jacobian of the distortion must be positive, so that the
  /// radius grows, and the angle to the optical axis less than 80 degrees; the radius of a fisheye lens must grow up to
  /// the corners or to usable_angle. Takes less than a millisecond.
  std::string trouble() const;
  /// Warnings about unusual intrinsics that may be intended: a principal point far from the centre of the image, an
  /// unusual field of view or aspect ratio of the pixels and, `with_baseline`, an unusual baseline. Each text names the
  /// likely mistake and its remedy; see core/warning.hpp.
  std::vector<std::string> suspicions(bool with_baseline) const;

  /// Bounding rectangle [minimum, maximum] of the undistorted pixels of the whole image.
  void undistorted_bounds(Eigen::Vector2d& minimum, Eigen::Vector2d& maximum) const;
};

/// Returns the calibration of a camera known by name, or nothing. Names: tum_fr1, tum_fr2, tum_fr3 (TUM RGB-D
/// calibration page), bonn (Bonn RGB-D Dynamic), euroc (left camera of EuRoC MAV), icl_nuim, kinect2 (960x540),
/// kitti_00, kitti_03, kitti_04 (KITTI's odometry sequences 00 to 02, 03, and 04 to 12; rectified).
std::optional<Camera> find_camera(const std::string& name);
/// All names that find_camera() accepts, sorted.
std::vector<std::string> camera_names();

}  // namespace holdfast
