// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/stereo_calibration.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace holdfast {

namespace {

double huber_weight(double deviations) {
  constexpr double limit = 1.5, hopeless = 6.0;  // standard deviations; a match beyond the second is wrong
  if (!(deviations < hopeless)) return 0.0;
  return deviations <= limit ? 1.0 : limit / deviations;
}

constexpr double minimum_step = 0.02;  // px, worth the correction of all keyframes

/// Brings an error in use up to date: `found`, with its standard deviation, where 1 displaces something by `effect` px.
/// An error begins to be used if it is significant, and stays in use.
void use(double found, double sigma, double effect, bool& is_used, double& used) {
  constexpr double significance = 4.0;  // standard deviations
  const double step = std::abs(found - used) * effect;
  const bool begins = step > StereoCalibration::minimum_shift && std::abs(found - used) > significance * sigma;
  if (!begins && !(is_used && step > minimum_step)) return;
  is_used = true;
  used = found;
}

Eigen::Vector4d row_terms(double x, double y) { return {1.0, x, y, x * y}; }
/// c and q of ColumnEstimate.
Eigen::Vector2d columns_of(const PairErrors& errors, double fx) {
  const double turn = fx * errors.rotation.y();
  return {turn + errors.column_offset, turn};
}

/// Mean of the products of 1 and x^2 over the image.
Eigen::Matrix2d mean_square(const Camera& camera) {
  const double left = -camera.cx / camera.fx, right = (camera.width - camera.cx) / camera.fx, width = right - left;
  const double second = (std::pow(right, 3) - std::pow(left, 3)) / (3.0 * width);
  const double fourth = (std::pow(right, 5) - std::pow(left, 5)) / (5.0 * width);
  return (Eigen::Matrix2d() << 1.0, second, second, fourth).finished();
}

/// Chi-square of columns that is no chance: one in a thousand exceeds it with two degrees of freedom, one in 5000 with
/// one.
constexpr double significant = 13.8;

}  // namespace

StereoCalibration::StereoCalibration(const Camera& camera, const PairErrors& errors, bool estimates)
    : camera_(camera), estimates_(estimates), column_area_(mean_square(camera)) {
  estimate_.errors = errors_of_frame_ = errors;
  given_columns_ = columns_of(errors, camera.fx);
}

PairErrors StereoCalibration::errors() const {
  const std::lock_guard lock(mutex_);
  return estimate_.errors;
}

PairEstimate StereoCalibration::estimate() const {
  const std::lock_guard lock(mutex_);
  return estimate_;
}

PairErrors StereoCalibration::begin_frame() {
  const std::lock_guard lock(mutex_);
  return errors_of_frame_ = estimate_.errors;
}

PairErrors StereoCalibration::errors_of_frame() const {
  const std::lock_guard lock(mutex_);
  return errors_of_frame_;
}

bool StereoCalibration::learn_rows(std::span<const RowDifference> differences) {
  constexpr std::size_t minimum_count = 50;
  constexpr double remembered = 0.98;  // of the earlier pairs
  constexpr double repetition = 4.0;   // consecutive pairs show the same points: so many count as one
  if (!estimates_ || differences.size() < minimum_count) return false;
  const std::lock_guard lock(mutex_);
  row_normal_ *= remembered;
  row_gradient_ *= remembered;
  for (const RowDifference& d : differences) {
    const Eigen::Vector4d row = row_terms((d.x - camera_.cx) / camera_.fx, (d.y - camera_.cy) / camera_.fy);
    const double weight =
        huber_weight(std::abs(d.difference - row.dot(row_solution_)) / d.sigma) / (d.sigma * d.sigma * repetition);
    row_normal_ += weight * row * row.transpose();
    row_gradient_ += weight * d.difference * row;
  }
  return use_rows();
}

bool StereoCalibration::use_rows() {
  const Eigen::LDLT<Eigen::Matrix4d> factor(row_normal_);
  if (factor.info() != Eigen::Success || !(factor.rcond() > 1e-6)) return false;
  row_solution_ = factor.solve(row_gradient_);
  const Eigen::Vector4d sigma = factor.solve(Eigen::Matrix4d::Identity()).diagonal().cwiseSqrt() / camera_.fy;
  const Eigen::Vector4d found = row_solution_ / camera_.fy;
  // What the errors displace at the border of the image: rows, or columns, which matter more.
  const double half_width = 0.5 * camera_.width, half_height = 0.5 * camera_.height;
  PairErrors& errors = estimate_.errors;
  const PairErrors before = errors;
  use(-found[0], sigma[0], camera_.fy, uses_pitch_, errors.rotation.x());
  use(found[1], sigma[1], half_height, uses_roll_, errors.rotation.z());
  use(1.0 + found[2], sigma[2], half_width, uses_ratio_, errors.focal_ratio);
  use(found[3], sigma[3], half_width * half_height / camera_.fy, uses_product_, errors.row_product);
  estimate_.rotation_sigma.x() = sigma[0];
  estimate_.rotation_sigma.z() = sigma[1];
  estimate_.focal_ratio_sigma = sigma[2];
  return errors != before;
}

void StereoCalibration::learn_columns(const ColumnEstimate& estimate, const PairErrors& used, bool window_is_complete) {
  if (!estimates_ || !estimate.value.allFinite() || !estimate.information.allFinite()) return;
  const std::lock_guard lock(mutex_);
  window_normal_ = estimate.information;
  window_gradient_ = estimate.information * (estimate.value + columns_of(used, camera_.fx));
  use_columns();
  if (!window_is_complete) return;
  column_normal_ += window_normal_;
  column_gradient_ += window_gradient_;
  window_normal_.setZero();
  window_gradient_.setZero();
}

/// c and q of ColumnEstimate. A turn is the cause unless the difference to it is significant: q is determined several
/// times worse than c, and a turn displaces both alike.
ColumnEstimate StereoCalibration::solve_columns() const {
  // A pair that is used as rectified has errors of about a pixel.
  const Eigen::Matrix2d normal = column_normal_ + window_normal_ + Eigen::Matrix2d::Identity();
  const Eigen::Vector2d gradient = column_gradient_ + window_gradient_;
  const Eigen::Matrix2d covariance = normal.inverse();
  const Eigen::Vector2d found = covariance * gradient - given_columns_;
  const double difference = found[1] - found[0];
  const double variance = covariance(0, 0) + covariance(1, 1) - 2.0 * covariance(0, 1);
  if (difference * difference > significant * variance) return {given_columns_ + found, normal};
  const double turn = (gradient - normal * given_columns_).sum() / normal.sum();
  return {given_columns_ + Eigen::Vector2d::Constant(turn), normal};
}

void StereoCalibration::use_columns() {
  const auto [found, normal] = solve_columns();
  const Eigen::Matrix2d covariance = normal.inverse();
  PairErrors& errors = estimate_.errors;
  estimate_.shift = found[0];
  estimate_.shift_sigma = std::sqrt(covariance(0, 0));
  estimate_.rotation_sigma.y() = std::sqrt(covariance(1, 1)) / camera_.fx;
  const Eigen::Vector2d step = found - columns_of(errors, camera_.fx);
  const double shift = std::sqrt(step.dot(column_area_ * step)), chi_square = step.dot(normal * step);
  const bool begins = shift > minimum_shift && chi_square > significant;
  if (!begins && !(uses_columns_ && shift > minimum_step)) return;
  uses_columns_ = true;
  errors.rotation.y() = found[1] / camera_.fx;
  errors.column_offset = found[0] - found[1];
}

}  // namespace holdfast
