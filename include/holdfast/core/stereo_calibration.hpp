// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <mutex>
#include <span>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/pair_errors.hpp"

namespace holdfast {

/// Estimated column displacement in the right image, c + q r^2 + m x + k x r^2 [px], from a window of keyframes (x, y:
/// normalised image coordinates, r^2 = x^2 + y^2). `value` is (c, q, m, k), relative to the errors already corrected;
/// `information` is its inverse covariance.
///
/// m is that of the ratio of focal lengths, k that of radial distortion, and c and q those of the rotation about y and
/// the principal point. Such a rotation has 1 + x^2; the part of y^2 is that of decentring: the product x y in the
/// rows, which is known as soon as it matters, is that of the rotation about y less the decentring, so that more of the
/// first is more of the second.
struct ColumnEstimate {
  Eigen::Vector4d value = Eigen::Vector4d::Zero();
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
};

/// Online self-calibration of a rectified stereo pair, by least squares of two kinds of measurements. The row
/// differences of matched features (zero for an ideal pair) determine the rotations about x and z, the ratio of focal
/// lengths, radial distortion, and the rotation about y less the decentring. The displacement of columns, estimated by
/// bundle adjustment over several keyframes (mapping/pair_calibrator.hpp), determines the rotation about y and the
/// column of the principal point, and the ratio of focal lengths and radial distortion better than rows.
///
/// An error is corrected only if it is significant and displaces points by more than `minimum_shift`, so that a perfect
/// calibration is not changed. The displacement of most errors is that at the image border; that of rotation about y
/// and principal point is their joint root mean square over the image. Once these two are corrected, so are the ratio
/// of focal lengths and radial distortion, from 0.02 px on, because what is left out of the columns is taken for an
/// error of the others. The simpler cause is preferred unless the measurements significantly contradict it: no radial
/// distortion while columns are not corrected, and a rotation about y without an error of the principal point.
/// Thread-safe.
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

  /// Updates the errors by the row differences of one frame. Returns true if the corrected errors have changed.
  bool learn_rows(std::span<const RowDifference> differences);
  /// Updates the errors by the estimate of a window of keyframes, whose disparities were corrected by `used`. Replaces
  /// the estimate of the last call, unless that window was complete.
  void learn_columns(const ColumnEstimate& estimate, const PairErrors& used, bool window_is_complete);

 private:
  static constexpr int unknowns = 7;
  using Vector = Eigen::Matrix<double, unknowns, 1>;
  using Matrix = Eigen::Matrix<double, unknowns, unknowns>;
  struct Solution {
    Vector value;
    Matrix covariance;
    bool has_offset;  ///< whether the principal point has an error beside a rotation about y
  };

  Vector unknowns_of(const PairErrors& errors) const;
  Solution solve() const;
  /// Brings the errors in use up to date; true if they have changed.
  bool use_solution();
  void use_columns(const Vector& found, const Matrix& covariance, bool has_offset);

  Camera camera_;
  bool estimates_;
  mutable std::mutex mutex_;
  PairEstimate estimate_;
  PairErrors errors_of_frame_;
  bool uses_pitch_ = false, uses_roll_ = false, uses_ratio_ = false, uses_product_ = false, uses_radial_ = false,
       uses_columns_ = false;
  Vector given_;     // the initial errors
  Vector solution_;  // of the last solve()
  // Normal equations: of rows, of complete windows of columns, and of the present window.
  Matrix row_normal_ = Matrix::Zero(), column_normal_ = Matrix::Zero(), window_normal_ = Matrix::Zero();
  Vector row_gradient_ = Vector::Zero(), column_gradient_ = Vector::Zero(), window_gradient_ = Vector::Zero();
  Eigen::Matrix2d column_area_;  // the mean square of c + q r^2 over the image is (c, q) column_area_ (c, q)^T
};

}  // namespace holdfast
