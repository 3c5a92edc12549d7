// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <mutex>
#include <span>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/pair_errors.hpp"

namespace holdfast {

/// Estimated column displacement in the right image, c + q x^2 [px] (x: normalised column), from a window of keyframes.
/// c and q are relative to the errors already corrected; `information` is their inverse covariance.
struct ColumnEstimate {
  Eigen::Vector2d value = Eigen::Vector2d::Zero();
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
};

/// Online self-calibration of a rectified stereo pair. The row differences of matched features (zero for an ideal pair)
/// determine the rotations about x and z and the ratio of focal lengths. The rotation about y and the column of the
/// principal point displace columns only; they are estimated by bundle adjustment over several keyframes
/// (mapping/pair_calibrator.hpp).
///
/// An error is corrected only if it is significant and displaces points by more than `minimum_shift`, so that a perfect
/// calibration is not changed. The displacement of each row error is that at the image border; that of the two column
/// errors is their joint root mean square over the image. The displacement of columns is attributed to the rotation
/// about y alone unless the motion significantly contradicts it. Thread-safe.
class StereoCalibration {
 public:
  static constexpr double minimum_shift = 0.1;  ///< px; the matching of images has biases up to a few hundredths

  /// `errors` are the initial values, which learn_rows() and learn_columns() refine if `estimates` is true.
  StereoCalibration(const Camera& camera, const PairErrors& errors, bool estimates);

  bool is_estimated() const { return estimates_; }
  PairErrors errors() const;
  PairEstimate estimate() const;
  /// Fixes the errors that correct a new frame and returns them; errors_of_frame() returns the same until the next
  /// call.
  PairErrors begin_frame();
  PairErrors errors_of_frame() const;

  /// Updates rotations about x and z and the focal ratio by the row differences of one frame. Returns true if the
  /// corrected errors have changed.
  bool learn_rows(std::span<const RowDifference> differences);
  /// Updates the rotation about y and the column of the principal point by the estimate of a window of keyframes, whose
  /// disparities were corrected by `used`. Replaces the estimate of the last call, unless that window was complete.
  void learn_columns(const ColumnEstimate& estimate, const PairErrors& used, bool window_is_complete);

 private:
  bool use_rows();
  ColumnEstimate solve_columns() const;
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
  Eigen::Vector2d given_columns_;  // of the initial errors
  Eigen::Matrix2d column_area_;    // mean square of c + q x^2 over the image is (c, q) column_area_ (c, q)^T
};

}  // namespace holdfast
