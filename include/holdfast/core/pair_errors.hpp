// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "holdfast/core/camera.hpp"

namespace holdfast {

/// Calibration errors of a rectified stereo pair: a small rotation of the right camera relative to the left one (about
/// the axes of the camera frame), the ratio of the right to the left focal length, and a column offset of the right
/// principal point.
struct PairErrors {
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();  ///< [rad]
  double focal_ratio = 1.0;
  double column_offset = 0.0;  ///< of the right principal point [px]
  /// Coefficient of x y in the normalised row difference (x, y: normalised image coordinates). It contains the effect
  /// of rotation.y() and residual lens distortion, and does not affect columns.
  double row_product = 0.0;

  /// Horizontal displacement [px], positive to the right, of a point in the right image that an ideal pair shows at
  /// (right_x, y). First order in the errors, second order in the position.
  double column(const Camera& camera, double right_x, double y) const {
    const Eigen::Vector2d at = camera.normalised(right_x, y);
    return camera.fx * (rotation.y() * (1.0 + at.x() * at.x()) - rotation.x() * at.x() * at.y() -
                        rotation.z() * at.y() + (focal_ratio - 1.0) * at.x()) +
           column_offset;
  }
  /// Vertical displacement [px], positive downwards.
  double row(const Camera& camera, double right_x, double y) const {
    const Eigen::Vector2d at = camera.normalised(right_x, y);
    return camera.fy *
           (-rotation.x() + rotation.z() * at.x() + (focal_ratio - 1.0) * at.y() + row_product * at.x() * at.y());
  }
  bool operator==(const PairErrors&) const = default;
};

/// Calibration errors of a pair that are corrected, and their estimates by self-calibration.
struct PairEstimate {
  PairErrors errors;
  Eigen::Vector3d rotation_sigma = Eigen::Vector3d::Zero();  ///< standard deviations; 0 = not estimated [rad]
  double focal_ratio_sigma = 0.0;
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
