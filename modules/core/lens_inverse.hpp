// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "holdfast/core/camera.hpp"

namespace holdfast {

/// Distance from the principal point, in focal lengths, of a ray at an angle to the optical axis of a fisheye lens.
double fisheye_radius(const Distortion& distortion, double angle);
/// Its derivative by the angle.
double fisheye_slope(const Distortion& distortion, double angle);

/// Numerator and denominator of the factor by which the radial-tangential distortion moves a point of the plane z = 1,
/// at the squared distance `r2` from the optical axis, away from it. Without k4, k5 and k6 the denominator is
/// exactly 1.
inline double radial_numerator(const Distortion& d, double r2) { return 1.0 + r2 * (d.k1 + r2 * (d.k2 + r2 * d.k3)); }
inline double radial_denominator(const Distortion& d, double r2) { return 1.0 + r2 * (d.k4 + r2 * (d.k5 + r2 * d.k6)); }

/// Radial-tangential distortion of a point of the plane z = 1.
inline Eigen::Vector2d distort_radial_tangential(const Distortion& d, double x, double y) {
  const double r2 = x * x + y * y;
  const double radial = radial_numerator(d, r2) / radial_denominator(d, r2);
  return {x * radial + 2.0 * d.p1 * x * y + d.p2 * (r2 + 2.0 * x * x),
          y * radial + d.p1 * (r2 + 2.0 * y * y) + 2.0 * d.p2 * x * y};
}

/// Result of invert_distortion().
struct LensInverse {
  Eigen::Vector2d point = Eigen::Vector2d::Zero();  ///< undistorted, in the plane z = 1
  /// How far the inverse exists on the straight line from the principal point to the raw position: 1 = to its end;
  /// otherwise `point` is the last one that exists.
  double share = 0.0;
  bool is_too_wide = false;  ///< the line was left at LensInverse::widest_angle

  bool is_complete() const { return share >= 1.0; }

  /// Angle to the optical axis [rad] that ends the line: 80 degrees.
  static constexpr double widest_angle = 1.3962634015954636;
};

/// Inverse of the radial-tangential distortion by continuation: follows the straight line from the principal point to
/// `raw` (in the plane z = 1) in the image, with Newton steps that are halved where they move the undistorted point too
/// far, and ends where the determinant of the Jacobian is not positive, that is, where the distortion turns back. It
/// finds the inverse that is connected with the optical axis, where a fixed-point iteration may diverge or find another
/// one.
LensInverse invert_distortion(const Distortion& distortion, const Eigen::Vector2d& raw);

}  // namespace holdfast
