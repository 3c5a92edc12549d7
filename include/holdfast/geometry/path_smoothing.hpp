// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "holdfast/core/median.hpp"

/// Fixed-interval smoothing of a measured path with a white-noise-on-acceleration prior (Anderson and Barfoot, "Full
/// STEAM ahead: exactly sparse Gaussian process regression for batch continuous-time trajectory estimation on SE(3)",
/// IROS 2015, equations 8 to 12 in a vector space).
///
/// How much is smoothed is not given but found, from leave-one-out predictions of the measurements. Errors of a tracked
/// camera grow for some frames and have outliers: the standard deviation of a measurement is in proportion to the
/// smallest error of prediction around it, by any ratio of the prior's power spectral density to the variance of the
/// measurements. With these weights, the ratio is the one with the smallest mean error of prediction, in deviations.
/// Outliers have Cauchy's robust factor. No position is moved by more than four errors of prediction around it, so that
/// a fast motion that its neighbours predict is kept.
namespace holdfast::geometry {

/// The smoothed positions of measurements at increasing times [s], in the order and unit of `measured`; the
/// measured ones where fewer than five are given. Times that are further apart than 3.5 median intervals are not
/// linked.
std::vector<Eigen::Vector3d> smooth_path(std::span<const double> times, std::span<const Eigen::Vector3d> measured);

namespace detail {

/// The normal equations of the states (position, velocity) of a path, block tridiagonal with blocks of 2: one matrix
/// for all three coordinates.
class PathSystem {
 public:
  explicit PathSystem(std::span<const double> times) : prior_(times.size(), {zero(), zero()}), steps_(times.size()) {
    std::vector<double> intervals;
    for (std::size_t i = 1; i < times.size(); ++i) intervals.push_back(times[i] - times[i - 1]);
    interval_ = upper_median(intervals);
    for (std::size_t i = 1; i < times.size(); ++i)
      if (const double step = (times[i] - times[i - 1]) / interval_; step <= 3.5) link(i, std::max(step, 0.01));
  }

  /// Median interval of the times [s].
  double interval() const { return interval_; }

  /// Whether both neighbours of a measurement are linked with it.
  bool is_between(std::size_t i) const {
    return i + 1 < prior_.size() && !prior_[i][1].isZero() && !prior_[i + 1][1].isZero();
  }

  /// Minimises the sum of weights * |position - measured|^2 and of the prior's cost divided by `ratio` (its power
  /// spectral density [unit^2/interval^3] by the variance of a measurement). `leverage`, if not null, gets the
  /// derivatives of the smoothed by the measured positions.
  void solve(double ratio, std::span<const double> weights, std::span<const Eigen::Vector3d> measured,
             std::vector<Eigen::Vector3d>& smoothed, std::vector<double>* leverage) {
    const std::size_t size = measured.size();
    for (std::size_t i = 0; i < size; ++i) {
      Eigen::Matrix2d diagonal = prior_[i][0] / ratio;
      diagonal(0, 0) += weights[i];
      diagonal(1, 1) += 1e-12;  // the velocity of a position that is not linked
      steps_[i].right.setZero();
      steps_[i].right.row(0) = weights[i] * measured[i].transpose();
      if (i > 0) {
        steps_[i].factor = prior_[i][1] / ratio * steps_[i - 1].inverse;
        diagonal -= steps_[i].factor * prior_[i][1].transpose() / ratio;
        steps_[i].right -= steps_[i].factor * steps_[i - 1].right;
      }
      steps_[i].inverse = diagonal.inverse();
    }
    Eigen::Matrix<double, 2, 3> state = Eigen::Matrix<double, 2, 3>::Zero();
    Eigen::Matrix2d covariance = zero();
    for (std::size_t i = size; i-- > 0;) {
      state = i + 1 < size ? (steps_[i].inverse * steps_[i].right - steps_[i + 1].factor.transpose() * state).eval()
                           : (steps_[i].inverse * steps_[i].right).eval();
      smoothed[i] = state.row(0);
      if (leverage == nullptr) continue;
      covariance =
          i + 1 < size
              ? (steps_[i].inverse + steps_[i + 1].factor.transpose() * covariance * steps_[i + 1].factor).eval()
              : steps_[i].inverse;
      (*leverage)[i] = covariance(0, 0) * weights[i];
    }
  }

 private:
  struct Step {
    Eigen::Matrix2d factor = zero(), inverse = zero();
    Eigen::Matrix<double, 2, 3> right;
  };
  static Eigen::Matrix2d zero() { return Eigen::Matrix2d::Zero(); }

  /// Adds the prior's cost between the states i - 1 and i; `step` in intervals.
  void link(std::size_t i, double step) {
    Eigen::Matrix2d information, transition;
    information << 12.0 / (step * step * step), -6.0 / (step * step), -6.0 / (step * step), 4.0 / step;
    transition << 1.0, step, 0.0, 1.0;
    prior_[i - 1][0] += transition.transpose() * information * transition;
    prior_[i][0] += information;
    prior_[i][1] = -information * transition;
  }

  double interval_ = 0.0;
  std::vector<std::array<Eigen::Matrix2d, 2>> prior_;  ///< diagonal block, and the one to its left
  std::vector<Step> steps_;
};

/// Takes the smaller of `least` and the root mean square of the errors within seven measurements to each side. Those at
/// the ends of a path are extrapolated, and not counted; without any other it is 0.
inline void take_least_mean(const PathSystem& system, const std::vector<double>& errors, std::vector<double>& least) {
  constexpr std::size_t reach = 7;
  const std::size_t size = errors.size();
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t first = i < reach ? 0 : i - reach, last = std::min(size, i + reach + 1);
    double sum = 0.0, count = 0.0;
    for (std::size_t k = first; k < last; ++k)
      if (system.is_between(k)) sum += errors[k] * errors[k], count += 1.0;
    least[i] = std::min(least[i], std::sqrt(sum / std::max(count, 1.0)));
  }
}

/// Errors of prediction of all measurements by the others, with this ratio and these weights.
inline void predict_measurements(PathSystem& system, double ratio, std::span<const double> weights,
                                 std::span<const Eigen::Vector3d> measured, std::vector<double>& errors) {
  std::vector<double> leverage(measured.size());
  std::vector<Eigen::Vector3d> smoothed(measured.size());
  system.solve(ratio, weights, measured, smoothed, &leverage);
  for (std::size_t i = 0; i < measured.size(); ++i)
    errors[i] = (smoothed[i] - measured[i]).norm() / std::max(1e-6, 1.0 - leverage[i]);
}

/// The smallest root mean square of the errors of prediction around each measurement, by ratios from 10^-3 to 10^3.
inline std::vector<double> unpredicted(PathSystem& system, std::span<const Eigen::Vector3d> measured) {
  const std::vector<double> weights(measured.size(), 1.0);
  std::vector<double> errors(measured.size()), least(measured.size(), std::numeric_limits<double>::infinity());
  for (double exponent = -3.0; exponent < 3.25; exponent += 0.5) {
    predict_measurements(system, std::pow(10.0, exponent), weights, measured, errors);
    take_least_mean(system, errors, least);
  }
  return least;
}

/// The ratio, up to 10^6, whose errors of prediction are the smallest in deviations, of which five count at most.
inline double best_ratio(PathSystem& system, std::span<const double> weights, std::span<const double> deviations,
                         std::span<const Eigen::Vector3d> measured) {
  std::vector<double> errors(measured.size());
  double best = 1.0, smallest = std::numeric_limits<double>::infinity();
  for (double exponent = -3.0; exponent < 6.25; exponent += 0.5) {
    const double ratio = std::pow(10.0, exponent);
    predict_measurements(system, ratio, weights, measured, errors);
    double sum = 0.0;
    for (std::size_t i = 0; i < measured.size(); ++i)
      if (system.is_between(i)) sum += std::min(5.0, errors[i] / deviations[i]);
    if (sum < smallest) best = ratio, smallest = sum;
  }
  return best;
}

}  // namespace detail

inline std::vector<Eigen::Vector3d> smooth_path(std::span<const double> times,
                                                std::span<const Eigen::Vector3d> measured) {
  constexpr double least_share = 0.3;   // of the median deviation
  constexpr double cauchy = 2.0;        // scale of the kernel in deviations
  constexpr double largest_move = 4.0;  // in errors of prediction
  const std::size_t size = measured.size();
  std::vector<Eigen::Vector3d> smoothed(measured.begin(), measured.end());
  if (size < 5) return smoothed;
  detail::PathSystem system(times);
  if (!(system.interval() > 0.0)) return smoothed;
  const std::vector<double> unpredicted = detail::unpredicted(system, measured);
  std::vector<double> sorted = unpredicted, deviations(size), weights(size);
  const double spread = upper_median(sorted);
  if (!(spread > 0.0) || !std::isfinite(spread)) return smoothed;
  for (std::size_t i = 0; i < size; ++i) {
    deviations[i] = std::max(unpredicted[i], least_share * spread);
    weights[i] = spread * spread / (deviations[i] * deviations[i]);
  }
  const double ratio = detail::best_ratio(system, weights, deviations, measured);
  system.solve(ratio, weights, measured, smoothed, nullptr);
  for (std::size_t i = 3; i + 3 < size; ++i) {
    if (!system.is_between(i - 2) || !system.is_between(i + 2)) continue;
    const double scaled = (smoothed[i] - measured[i]).norm() / (cauchy * deviations[i]);
    weights[i] /= 1.0 + scaled * scaled;
  }
  system.solve(ratio, weights, measured, smoothed, nullptr);
  for (std::size_t i = 0; i < size; ++i) {
    const Eigen::Vector3d move = smoothed[i] - measured[i];
    if (const double largest = largest_move * unpredicted[i]; move.norm() > largest)
      smoothed[i] = measured[i] + largest / move.norm() * move;
  }
  return smoothed;
}

}  // namespace holdfast::geometry
