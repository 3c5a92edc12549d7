// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "holdfast/geometry/pose_problem.hpp"
#include "holdfast/geometry/pose_system.hpp"
#include "holdfast/geometry/se3.hpp"

/// Definition of adjust_pose(), whose contract is in pose_problem.hpp.
namespace holdfast::geometry {

namespace detail {

/// Whether all numbers of an observation are finite; right_x may be missing (NaN).
template <class Problem>
bool is_finite(const Problem& problem, std::size_t i) {
  using Traits = PoseProblemTraits<Problem>;
  const double inverse_variance = information(problem, i);
  return Traits::point(problem, i).allFinite() && Traits::pixel(problem, i).allFinite() &&
         !std::isinf(right_x(problem, i)) && std::isfinite(inverse_variance) && std::isfinite(weight(problem, i)) &&
         inverse_variance > 0.0;
}

/// Stopping criteria of a round of Levenberg-Marquardt.
struct RoundLimits {
  int iterations;   ///< at most
  double relative;  ///< converged when the predicted decrease is below this factor times the cost, and below `absolute`
  double absolute;  ///< half the squared Mahalanobis distance from the pose to the predicted minimum
};

/// The state of adjust_pose(): observations in batches, the current pose and its normal equations. A class template, so
/// that only callers of adjust_pose() compile the decompositions of Eigen.
template <class Problem>
class PoseAdjustment {
 public:
  PoseAdjustment(const Problem& problem, const PoseAdjustmentOptions& options, std::vector<ObservationBatch>& batches)
      : camera_(Traits::pinhole(problem)),
        pose_(Traits::pose(problem)),
        options_(options),
        disparity_limit_(options.disparity_threshold * options.disparity_threshold),
        batches_(batches) {}

  const Eigen::Isometry3d& pose() const { return pose_; }
  double cost() const { return system_.cost; }

  /// Fills the batches and returns the number of usable observations.
  int pack(const Problem& problem) {
    const double information_disparity = 1.0 / (options_.disparity_sigma * options_.disparity_sigma);
    const std::size_t size = Traits::size(problem);
    batches_.assign((size + batch_size - 1) / batch_size, ObservationBatch{});
    int count = 0;
    for (std::size_t i = 0; i < size; ++i) {
      ObservationBatch& batch = batches_[i / batch_size];
      const std::size_t k = i % batch_size;
      batch.limit[k] = options_.chi_square_2d;
      batch.point_z[k] = 1.0;
      if (!is_finite(problem, i)) continue;
      const Eigen::Vector3d point = Traits::point(problem, i);
      const Eigen::Vector2d pixel = Traits::pixel(problem, i);
      batch.point_x[k] = point.x();
      batch.point_y[k] = point.y();
      batch.point_z[k] = point.z();
      batch.x[k] = pixel.x();
      batch.y[k] = pixel.y();
      batch.information[k] = information(problem, i);
      if (const double right = right_x(problem, i); !std::isnan(right)) {
        batch.right_x[k] = right;
        batch.information_right[k] = batch.information[k];
        batch.information_disparity[k] = information_disparity;
        batch.limit[k] = options_.chi_square_3d;
      }
      batch.full_weight[k] = batch.weight[k] = std::max(0.0, weight(problem, i));
      count += batch.weight[k] > 0.0;
    }
    return count;
  }

  /// Reclassifies every observation at the current pose. Returns whether the inlier set has changed.
  bool set_outliers_aside() {
    chi_squares(batches_, PoseView(camera_, pose_));
    bool changed = false;
    for (ObservationBatch& batch : batches_) {
      for (std::size_t k = 0; k < batch_size; ++k) {
        const double weight = is_inlier(batch, k) ? batch.full_weight[k] : 0.0;
        changed |= weight != batch.weight[k];
        batch.weight[k] = weight;
      }
    }
    return changed;
  }

  /// Whether observation i passed the last test, whatever its weight.
  bool is_inlier(std::size_t i) const { return is_inlier(batches_[i / batch_size], i % batch_size); }
  /// Number of observations with non-zero weight that passed the last test.
  int count_inliers() const {
    int count = 0;
    for (const ObservationBatch& batch : batches_)
      for (std::size_t k = 0; k < batch_size; ++k) count += batch.weight[k] > 0.0;
    return count;
  }

  /// One round of Levenberg-Marquardt. Returns the number of iterations.
  int minimise(bool robust, const RoundLimits& limits) {
    double damping = 1e-7;
    build_system(batches_, PoseView(camera_, pose_), disparity_limit_, robust, system_);
    PoseSystem candidate;
    for (int iteration = 0; iteration < limits.iterations; ++iteration) {
      Matrix6d damped = system_.hessian;
      damped.diagonal() *= 1.0 + damping;
      const Eigen::LDLT<Matrix6d> factor(damped);
      const Vector6d step = factor.solve(-system_.gradient);
      if (factor.info() != Eigen::Success || !step.allFinite()) return iteration;
      const double predicted = -0.5 * system_.gradient.dot(step);
      if (!(predicted > std::min(limits.relative * system_.cost, limits.absolute) + 1e-14)) return iteration;
      const Eigen::Isometry3d moved = orthonormalised(exp_se3(step) * pose_);
      build_system(batches_, PoseView(camera_, moved), disparity_limit_, robust, candidate);
      if (candidate.cost <= system_.cost) {
        pose_ = moved;
        std::swap(system_, candidate);
        damping = std::max(damping * 0.1, 1e-9);
      } else {
        damping = std::max(damping * 100.0, 1e-4);
      }
    }
    return limits.iterations;
  }

  /// Whether the observations determine all six degrees of freedom; fills the covariance.
  bool find_covariance(Matrix6d& covariance) const {
    const Vector6d scale = system_.hessian.diagonal().cwiseMax(0.0).cwiseSqrt();
    if (!(scale.minCoeff() > 0.0) || !scale.allFinite()) return false;
    const Vector6d inverse_scale = scale.cwiseInverse();
    const Matrix6d scaled = inverse_scale.asDiagonal() * system_.hessian * inverse_scale.asDiagonal();
    const Eigen::LLT<Matrix6d> factor(scaled);
    if (factor.info() != Eigen::Success || factor.rcond() < 1e-12) return false;
    covariance = inverse_scale.asDiagonal() * factor.solve(Matrix6d::Identity()) * inverse_scale.asDiagonal();
    return covariance.allFinite();
  }

 private:
  using Traits = PoseProblemTraits<Problem>;

  static bool is_inlier(const ObservationBatch& batch, std::size_t k) { return batch.chi_square[k] <= batch.limit[k]; }

  Pinhole camera_;
  Eigen::Isometry3d pose_;
  const PoseAdjustmentOptions& options_;
  double disparity_limit_;
  PoseSystem system_;  ///< of pose_, once minimise() was called
  std::vector<ObservationBatch>& batches_;
};

}  // namespace detail

template <PoseProblemType Problem>
PoseSummary adjust_pose(Problem& problem, const PoseAdjustmentOptions& options) {
  using Traits = PoseProblemTraits<Problem>;
  detail::begin(problem);
  thread_local std::vector<detail::ObservationBatch> batches;  // reused, so that tracking does not allocate per frame
  detail::PoseAdjustment<Problem> adjustment(problem, options, batches);
  PoseSummary summary;
  if (adjustment.pack(problem) < 3 || !adjustment.pose().matrix().allFinite()) return summary;

  if (options.trust_guess) adjustment.set_outliers_aside();
  bool settled = false;  // whether the last round left the set of outliers unchanged
  for (int round = 0; round < options.robust_rounds + options.final_rounds; ++round) {
    const bool robust = round < options.robust_rounds;
    if (settled && round != options.robust_rounds) continue;
    // Robust rounds only separate outliers from inliers and need less precision.
    const detail::RoundLimits limits{options.iterations, robust ? 1e-4 : 1e-8, robust ? 0.02 : 1e-4};
    summary.iterations += adjustment.minimise(robust, limits);
    settled = !adjustment.set_outliers_aside();
  }

  const int inliers = adjustment.count_inliers();
  if (inliers < 3 || !adjustment.pose().matrix().allFinite() || !adjustment.find_covariance(summary.covariance))
    return summary;

  const std::size_t size = Traits::size(problem);
  for (std::size_t i = 0; i < size; ++i)
    Traits::set_inlier(problem, i, adjustment.is_inlier(i) && detail::is_finite(problem, i));
  Traits::set_pose(problem, adjustment.pose());
  summary.usable = true;
  summary.inliers = inliers;
  summary.final_cost = adjustment.cost();
  return summary;
}

}  // namespace holdfast::geometry
