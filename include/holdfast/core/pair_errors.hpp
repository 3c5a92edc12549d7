// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "holdfast/core/camera.hpp"

namespace holdfast {

/// Errors of the calibration of a rectified pair: a small rotation of the right camera against the left one, about the
/// axes x, y and z of the camera frame, the ratio of the focal lengths of the right and the left camera, and the column
/// of the right principal point.
struct PairErrors {
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();  ///< [rad]
  double focal_ratio = 1.0;
  double column_offset = 0.0;  ///< of the right principal point [px]
  /// Coefficient of the product of column and row, both by focal length, in the differences of rows, by focal length.
  /// It includes the part of rotation.y(), and residual lens distortion. It displaces no columns.
  double row_product = 0.0;

  /// Displacement to the right [px] of a point in the right image against a perfect pair, which shows it in column
  /// `right_x` and row y. To the first order in the errors, to the second in the position.
  double column(const Camera& camera, double right_x, double y) const {
    const double normal_x = (right_x - camera.cx) / camera.fx, normal_y = (y - camera.cy) / camera.fy;
    return camera.fx * (rotation.y() * (1.0 + normal_x * normal_x) - rotation.x() * normal_x * normal_y -
                        rotation.z() * normal_y + (focal_ratio - 1.0) * normal_x) +
           column_offset;
  }
  /// The displacement downwards.
  double row(const Camera& camera, double right_x, double y) const {
    const double normal_x = (right_x - camera.cx) / camera.fx, normal_y = (y - camera.cy) / camera.fy;
    return camera.fy * (-rotation.x() + rotation.z() * normal_x + (focal_ratio - 1.0) * normal_y +
                        row_product * normal_x * normal_y);
  }
  bool operator==(const PairErrors&) const = default;
};

/// The errors of a pair's calibration that are corrected, and what self-calibration knows of them.
struct PairEstimate {
  PairErrors errors;
  Eigen::Vector3d rotation_sigma = Eigen::Vector3d::Zero();  ///< standard deviations; 0 = not estimated [rad]
  double focal_ratio_sigma = 0.0;
  double shift = 0.0;        ///< estimated displacement of columns at the principal point [px], corrected or not
  double shift_sigma = 0.0;  ///< its standard deviation; 0 = not estimated [px]
};

/// A feature that both images show: its position in the right image [px], and how much lower it lies there.
struct RowDifference {
  double x, y, difference;
  double sigma;  ///< [px]
};

}  // namespace holdfast
