// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/stereo_calibration.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

namespace holdfast {

namespace {

double huber_weight(double deviations) {
  constexpr double limit = 1.5, hopeless = 6.0;  // standard deviations; a match beyond the second is wrong
  if (!(deviations < hopeless)) return 0.0;
  return deviations <= limit ? 1.0 : limit / deviations;
}

constexpr double minimum_step = 0.02;  // px, worth the correction of all keyframes

/// Whether a change of an error, with its standard deviation, is worth to be corrected, where 1 displaces something by
/// `effect` px.
bool is_relevant(double change, double sigma, double effect) {
  constexpr double significance = 4.0;  // standard deviations
  return std::abs(change) * effect > StereoCalibration::minimum_shift && std::abs(change) > significance * sigma;
}

/// Brings an error in use up to date. An error begins to be used if it is relevant, and stays in use.
void use(double found, double sigma, double effect, bool& is_used, double& used) {
  const bool begins = is_relevant(found - used, sigma, effect);
  if (!begins && !(is_used && std::abs(found - used) * effect > minimum_step)) return;
  is_used = true;
  used = found;
}

// The unknowns, in normalised image coordinates; `product` is that of PairErrors::row_product(), `constant` and
// `quadratic` are c and q of ColumnEstimate.
enum Unknown : Eigen::Index { pitch, roll, ratio, radial, product, constant, quadratic };
constexpr std::array<Eigen::Index, 4> unknowns_of_columns{constant, quadratic, ratio, radial};

/// Mean of x^power from `first` to `last`.
double mean_power(double first, double last, int power) {
  return (std::pow(last, power + 1) - std::pow(first, power + 1)) / ((power + 1) * (last - first));
}

/// Mean of the products of 1 and x^2 + y^2 over the image.
Eigen::Matrix2d mean_square(const Camera& camera) {
  const double left = -camera.cx / camera.fx, right = (camera.width - camera.cx) / camera.fx;
  const double top = -camera.cy / camera.fy, bottom = (camera.height - camera.cy) / camera.fy;
  const double xx = mean_power(left, right, 2), yy = mean_power(top, bottom, 2);
  const double fourth = mean_power(left, right, 4) + 2.0 * xx * yy + mean_power(top, bottom, 4);
  return (Eigen::Matrix2d() << 1.0, xx + yy, xx + yy, fourth).finished();
}

/// Chi-square that is no chance: one in a thousand exceeds it with two degrees of freedom, one in 5000 with one.
constexpr double significant = 13.8;

/// How far 1 of radial distortion displaces a column at the border of the image [px].
double effect_of_radial(const Camera& camera) { return std::pow(0.5 * camera.width, 3) / (camera.fx * camera.fx); }

}  // namespace

StereoCalibration::StereoCalibration(const Camera& camera, const PairErrors& errors, bool estimates)
    : camera_(camera), estimates_(estimates), column_area_(mean_square(camera)) {
  estimate_.errors = errors_of_frame_ = errors;
  given_ = solution_ = unknowns_of(errors);
}

StereoCalibration::Vector StereoCalibration::unknowns_of(const PairErrors& errors) const {
  Vector unknown;
  unknown[pitch] = errors.rotation.x();
  unknown[roll] = errors.rotation.z();
  unknown[ratio] = errors.focal_ratio - 1.0;
  unknown[radial] = errors.radial;
  unknown[product] = errors.row_product();
  unknown[constant] = errors.rotation.y() + errors.column_offset / camera_.fx;
  unknown[quadratic] = errors.rotation.y();
  return unknown;
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
    const double x = (d.x - camera_.cx) / camera_.fx, y = (d.y - camera_.cy) / camera_.fy;
    Vector row = Vector::Zero();
    row[pitch] = -1.0, row[roll] = x, row[ratio] = y, row[radial] = y * (x * x + y * y), row[product] = x * y;
    const double difference = d.difference / camera_.fy, sigma = d.sigma / camera_.fy;
    const double weight =
        huber_weight(std::abs(difference - row.dot(solution_)) / sigma) / (sigma * sigma * repetition);
    row_normal_ += weight * row * row.transpose();
    row_gradient_ += weight * difference * row;
  }
  return use_solution();
}

void StereoCalibration::learn_columns(const ColumnEstimate& estimate, const PairErrors& used, bool window_is_complete) {
  constexpr double repetition = 2.0;  // keyframes show the same points: so many disparities count as one
  if (!estimates_ || !estimate.value.allFinite() || !estimate.information.allFinite()) return;
  const std::lock_guard lock(mutex_);
  const Eigen::Vector4d value = estimate.value / camera_.fx + Eigen::Vector4d(unknowns_of(used)(unknowns_of_columns));
  const Eigen::Matrix4d information = estimate.information * (camera_.fx * camera_.fx / repetition);
  window_normal_.setZero();
  window_gradient_.setZero();
  window_normal_(unknowns_of_columns, unknowns_of_columns) = information;
  window_gradient_(unknowns_of_columns) = information * value;
  use_solution();
  if (!window_is_complete) return;
  column_normal_ += window_normal_;
  column_gradient_ += window_gradient_;
  window_normal_.setZero();
  window_gradient_.setZero();
}

/// The solution in which causes that the measurements do not contradict are left out.
StereoCalibration::Solution StereoCalibration::solve() const {
  // A pair that is used as rectified has errors of about a pixel. The others only keep the system regular.
  Vector deviation = Vector::Constant(0.05);
  for (const Unknown unknown : {radial, constant, quadratic}) deviation[unknown] = 1.0 / camera_.fx;
  const Matrix information = row_normal_ + column_normal_ + window_normal_;
  const Matrix normal = information + Matrix(deviation.cwiseAbs2().cwiseInverse().asDiagonal());
  const Vector gradient = row_gradient_ + column_gradient_ + window_gradient_ - information * given_;
  // Of the differences to what is given.
  const Matrix covariance = normal.ldlt().solve(Matrix::Identity());
  const Vector found = covariance * gradient;
  const bool has_radial =
      uses_radial_ || is_relevant(found[radial], std::sqrt(covariance(radial, radial)), effect_of_radial(camera_));
  const double offset = found[quadratic] - found[constant];
  const bool has_offset =
      offset * offset > significant * (covariance(constant, constant) + covariance(quadratic, quadratic) -
                                       2.0 * covariance(constant, quadratic));
  // Columns of `by_free`: what each free unknown changes.
  using Free = Eigen::Matrix<double, unknowns, Eigen::Dynamic, 0, unknowns, unknowns>;
  using FreeSquare = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, unknowns, unknowns>;
  Matrix by_each = Matrix::Identity();
  if (!has_offset) by_each(quadratic, constant) = 1.0, by_each.col(quadratic).setZero();
  if (!has_radial) by_each.col(radial).setZero();
  Free by_free(unknowns, unknowns - (has_offset ? 0 : 1) - (has_radial ? 0 : 1));
  for (Eigen::Index i = 0, kept = 0; i < unknowns; ++i)
    if (by_each.col(i).any()) by_free.col(kept++) = by_each.col(i);
  const FreeSquare free_normal = by_free.transpose() * normal * by_free;
  const FreeSquare free_covariance = free_normal.inverse();
  return {given_ + by_free * (free_covariance * (by_free.transpose() * gradient)),
          by_free * free_covariance * by_free.transpose(), has_offset};
}

bool StereoCalibration::use_solution() {
  // What is left out of columns that are corrected is taken for their other errors.
  uses_ratio_ |= uses_columns_;
  uses_radial_ |= uses_columns_;
  const auto [found, covariance, has_offset] = solve();
  if (!found.allFinite()) return false;
  solution_ = found;
  const Vector sigma = covariance.diagonal().cwiseSqrt();
  // What the errors displace at the border of the image: rows, or columns, which matter more.
  const double half_width = 0.5 * camera_.width, half_height = 0.5 * camera_.height;
  PairErrors& errors = estimate_.errors;
  const PairErrors before = errors;
  use(found[pitch], sigma[pitch], camera_.fy, uses_pitch_, errors.rotation.x());
  use(found[roll], sigma[roll], half_height, uses_roll_, errors.rotation.z());
  use(1.0 + found[ratio], sigma[ratio], half_width, uses_ratio_, errors.focal_ratio);
  use(found[radial], sigma[radial], effect_of_radial(camera_), uses_radial_, errors.radial);
  double used_product = errors.row_product();
  use(found[product], sigma[product], half_width * half_height / camera_.fx, uses_product_, used_product);
  use_columns(found, covariance, has_offset);
  if (uses_product_) errors.decentring = errors.rotation.y() - used_product;
  const bool has_rows = row_normal_(pitch, pitch) > 0.0;
  const bool has_columns = column_normal_(constant, constant) + window_normal_(constant, constant) > 0.0;
  estimate_.focal_ratio_sigma = sigma[ratio];
  estimate_.radial_sigma = sigma[radial];
  if (has_rows) estimate_.rotation_sigma.x() = sigma[pitch], estimate_.rotation_sigma.z() = sigma[roll];
  if (has_columns) {
    estimate_.rotation_sigma.y() = sigma[quadratic];
    estimate_.shift = found[constant] * camera_.fx;
    estimate_.shift_sigma = sigma[constant] * camera_.fx;
  }
  if (has_rows && has_columns)
    estimate_.decentring_sigma = std::sqrt(covariance(quadratic, quadratic) + covariance(product, product) -
                                           2.0 * covariance(quadratic, product));
  return errors != before;
}

void StereoCalibration::use_columns(const Vector& found, const Matrix& covariance, bool has_offset) {
  constexpr std::array<Eigen::Index, 2> both{constant, quadratic};
  PairErrors& errors = estimate_.errors;
  const Eigen::Vector2d step = (found - unknowns_of(errors))(both);
  const Eigen::Matrix2d of_both = covariance(both, both);
  const double shift = std::sqrt(step.dot(column_area_ * step)) * camera_.fx;
  // Both are one unknown where a rotation is the only cause.
  const double chi_square = has_offset ? step.dot(of_both.inverse() * step) : step[0] * step[0] / of_both(0, 0);
  const bool begins = shift > minimum_shift && chi_square > significant;
  if (!begins && !(uses_columns_ && shift > minimum_step)) return;
  uses_columns_ = true;
  errors.rotation.y() = found[quadratic];
  errors.column_offset = (found[constant] - found[quadratic]) * camera_.fx;
}

}  // namespace holdfast
