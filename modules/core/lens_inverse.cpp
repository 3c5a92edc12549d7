// SPDX-License-Identifier: BSD-3-Clause
#include "lens_inverse.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace holdfast {

namespace {

/// Distorted position of a point in the plane z = 1, and its derivative by the point, which is symmetric.
struct DistortedPoint {
  Eigen::Vector2d position;
  Eigen::Matrix2d jacobian;
};

DistortedPoint distort_with_jacobian(const Distortion& d, const Eigen::Vector2d& point) {
  const double x = point.x(), y = point.y(), r2 = point.squaredNorm();
  const double denominator = radial_denominator(d, r2);
  const double numerator_slope = d.k1 + r2 * (2.0 * d.k2 + r2 * 3.0 * d.k3);  // by r2
  const double denominator_slope = d.k4 + r2 * (2.0 * d.k5 + r2 * 3.0 * d.k6);
  const double radial = radial_numerator(d, r2) / denominator;
  const double radial_slope = (numerator_slope - radial * denominator_slope) / denominator;
  DistortedPoint result;
  result.position = distort_radial_tangential(d, x, y);
  const double mixed = 2.0 * x * y * radial_slope + 2.0 * (d.p1 * x + d.p2 * y);
  result.jacobian << radial + 2.0 * x * x * radial_slope + 2.0 * d.p1 * y + 6.0 * d.p2 * x, mixed,  //
      mixed, radial + 2.0 * y * y * radial_slope + 6.0 * d.p1 * y + 2.0 * d.p2 * x;
  return result;
}

/// Newton's method from `point`, whose derivative is `jacobian`; false where it moves farther than `most`, leaves the
/// region where the distortion keeps the orientation, or does not converge.
bool step_to(const Distortion& d, const Eigen::Vector2d& target, double most, Eigen::Vector2d& point,
             DistortedPoint& there) {
  constexpr int most_iterations = 8;
  constexpr double tolerance = 1e-12, least_determinant = 1e-6;
  const Eigen::Vector2d start = point;
  for (int i = 0; i < most_iterations; ++i) {
    point += there.jacobian.inverse() * (target - there.position);
    if (!((point - start).norm() < most)) return false;
    there = distort_with_jacobian(d, point);
    if (!(there.jacobian.determinant() > least_determinant)) return false;
    if ((there.position - target).norm() < tolerance) return true;
  }
  return false;
}

}  // namespace

double fisheye_radius(const Distortion& d, double angle) {
  const double a2 = angle * angle;
  return angle * (1.0 + a2 * (d.k1 + a2 * (d.k2 + a2 * (d.k3 + a2 * d.k4))));
}

double fisheye_slope(const Distortion& d, double angle) {
  const double a2 = angle * angle;
  return 1.0 + a2 * (3.0 * d.k1 + a2 * (5.0 * d.k2 + a2 * (7.0 * d.k3 + a2 * 9.0 * d.k4)));
}

LensInverse invert_distortion(const Distortion& distortion, const Eigen::Vector2d& raw) {
  constexpr double longest_step = 0.05, shortest_share = 1e-6;
  const double limit = std::tan(LensInverse::widest_angle);
  LensInverse result;
  DistortedPoint there = distort_with_jacobian(distortion, result.point);
  double step = 1.0;
  while (!result.is_complete()) {
    const bool is_last = result.share + step >= 1.0;
    const double share = is_last ? 1.0 : result.share + step;
    Eigen::Vector2d point = result.point;
    DistortedPoint next = there;
    if (!step_to(distortion, share * raw, longest_step * (1.0 + point.norm()), point, next)) {
      step *= 0.5;
      if (step < shortest_share) return result;
      continue;
    }
    result.is_too_wide = !(point.norm() < limit);
    if (result.is_too_wide) return result;
    result.point = point;
    result.share = share;
    there = next;
    step *= 2.0;
  }
  return result;
}

}  // namespace holdfast
