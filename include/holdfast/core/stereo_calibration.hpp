// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <mutex>
#include <span>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/pair_errors.hpp"

namespace holdfast {

/// Estimate of the displacement of columns in the right image, c + q x^2 [px] (x: column there, from the principal
/// point by focal length), by the motion of a window of keyframes: c and q beyond the errors that were corrected
/// already, and their information (inverse covariance).
struct ColumnEstimate {
  Eigen::Vector2d value = Eigen::Vector2d::Zero();
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
};

/// Self-calibration of a rectified stereo pair while it moves. Rows determine the rotations about x and z and the ratio
/// of focal lengths: a rectified pair shows a point in the same row of both images. They do not determine the rotation
/// about y nor the column of the principal point, which displace columns only. Motion does, in a bundle adjustment with
/// these errors as unknowns (mapping/pair_calibrator.hpp).
///
/// An error is used once it displaces points by more than `minimum_shift` and is significant, so that a perfect
/// calibration is not changed: errors of rows one by one, by what they displace at the border of the image; the two of
/// columns together, by the root of the mean square over the image. Thread-safe.
class StereoCalibration {
 public:
  static constexpr double minimum_shift = 0.1;  ///< px; the matching of images has biases up to a few hundredths

  /// `estimates`: learn_rows() and learn_columns() improve the first errors.
  StereoCalibration(const Camera& camera, const PairErrors& errors, bool estimates);

  bool is_estimated() const { return estimates_; }
  PairErrors errors() const;
  PairEstimate estimate() const;
  /// The errors in use for a new frame; errors_of_frame() returns the same until the next call.
  PairErrors begin_frame();
  PairErrors errors_of_frame() const;

  /// Improves rotations about x and z and the focal ratio by the features of one pair. Returns true if the errors in
  /// use have changed.
  bool learn_rows(std::span<const RowDifference> differences);
  /// Improves the rotation about y and the column of the principal point by the motion of a window of keyframes, whose
  /// disparities `used` has corrected. Replaces the estimate of the last call, unless that window was complete.
  void learn_columns(const ColumnEstimate& estimate, const PairErrors& used, bool window_is_complete);

 private:
  bool use_rows();
  void use_columns();

  Camera camera_;
  bool estimates_;
  mutable std::mutex mutex_;
  PairEstimate estimate_;
  PairErrors errors_of_frame_;
  bool uses_pitch_ = false, uses_roll_ = false, uses_ratio_ = false, uses_product_ = false, uses_columns_ = false;
  // Normal equations of the differences of rows: constant, by column, by row, by their product.
  Eigen::Matrix4d row_normal_ = Eigen::Matrix4d::Zero();
  Eigen::Vector4d row_gradient_ = Eigen::Vector4d::Zero(), row_solution_ = Eigen::Vector4d::Zero();
  // Normal equations of ColumnEstimate, of complete windows and of the present one.
  Eigen::Matrix2d column_normal_ = Eigen::Matrix2d::Zero(), window_normal_ = Eigen::Matrix2d::Zero();
  Eigen::Vector2d column_gradient_ = Eigen::Vector2d::Zero(), window_gradient_ = Eigen::Vector2d::Zero();
  Eigen::Matrix2d column_area_;  // mean square of c + q x^2 over the image is (c, q) column_area_ (c, q)^T
};

}  // namespace holdfast
