// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "holdfast/core/camera.hpp"

namespace holdfast {

/// Calibration errors of a rectified stereo pair: a small rotation of the right camera relative to the left one (about
/// the axes of the camera frame), the ratio of the right to the left focal length, a column offset of the right
/// principal point, and residual radial and decentring distortion (k1 and p2 of Brown, Decentering distortion of
/// lenses, 1966).
///
/// The last two are differences of the lenses, as far points show them; p1, the other decentring term, is left out. A
/// radial distortion of k1 displaces columns by fx k1 x (x^2 + y^2) and rows by fy k1 y (x^2 + y^2).
///
/// A decentring of p2 displaces columns by fx p2 (3 x^2 + y^2) and rows by fy 2 p2 x y (x, y: normalised image
/// coordinates). Of this, 3 p2 (1 + x^2) and 3 p2 x y are those of a rotation about y, up to the constant 3 p2. The two
/// cannot be told apart, so `rotation.y()` and `column_offset` contain this part, and `decentring` stands for the rest.
struct PairErrors {
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();  ///< [rad]
  double focal_ratio = 1.0;
  double column_offset = 0.0;  ///< of the right principal point [px]
  double radial = 0.0;         ///< k1 of the right camera, less that of the left one; without unit
  double decentring = 0.0;     ///< p2 of the right camera, less that of the left one; without unit

  /// Horizontal displacement [px], positive to the right, of a point in the right image that an ideal pair shows at
  /// (right_x, y). First order in the errors.
  double column(const Camera& camera, double right_x, double y) const {
    const Eigen::Vector2d at = camera.normalised(right_x, y);
    return camera.fx *
               (rotation.y() * (1.0 + at.x() * at.x()) - rotation.x() * at.x() * at.y() - rotation.z() * at.y() +
                (focal_ratio - 1.0 + radial * at.squaredNorm()) * at.x() + decentring * at.y() * at.y()) +
           column_offset;
  }
  /// Vertical displacement [px], positive downwards.
  double row(const Camera& camera, double right_x, double y) const {
    const Eigen::Vector2d at = camera.normalised(right_x, y);
    return camera.fy * (-rotation.x() + rotation.z() * at.x() +
                        (focal_ratio - 1.0 + radial * at.squaredNorm()) * at.y() + row_product() * at.x() * at.y());
  }
  /// Coefficient of x y in the normalised row difference.
  double row_product() const { return rotation.y() - decentring; }
  bool operator==(const PairErrors&) const = default;
};

/// Calibration errors of a pair that are corrected, and their estimates by self-calibration.
struct PairEstimate {
  PairErrors errors;
  Eigen::Vector3d rotation_sigma = Eigen::Vector3d::Zero();  ///< standard deviations; 0 = not estimated [rad]
  double focal_ratio_sigma = 0.0;
  double radial_sigma = 0.0, decentring_sigma = 0.0;  ///< of radial also 0 where it is left out as not significant
  double shift = 0.0;        ///< estimated displacement of columns at the principal point [px], corrected or not
  double shift_sigma = 0.0;  ///< its standard deviation; 0 = not estimated [px]
};

/// Row difference of a feature matched in both images: its position in the right image [px] and the right row minus the
/// left one [px].
struct RowDifference {
  double x, y, difference;
  double sigma;  ///< [px]
};

}  // namespace holdfast
