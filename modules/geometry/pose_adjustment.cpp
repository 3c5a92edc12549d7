// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/geometry/pose_adjustment.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "holdfast/core/error.hpp"
#include "holdfast/geometry/se3.hpp"
#include "pose_system.hpp"

namespace holdfast::geometry {
namespace {

bool is_finite(const PoseProblem& problem, std::size_t i) {
  return problem.points[i].allFinite() && std::isfinite(problem.x[i]) && std::isfinite(problem.y[i]) &&
         !std::isinf(problem.right_x[i]) && std::isfinite(problem.inverse_sigma2[i]) &&
         std::isfinite(problem.weight[i]) && problem.inverse_sigma2[i] > 0.0f;
}

/// Fills the batches; returns how many observations count.
int pack(const PoseProblem& problem, const PoseAdjustmentOptions& options, std::vector<ObservationBatch>& batches) {
  const std::size_t size = problem.size();
  batches.assign((size + batch_size - 1) / batch_size, ObservationBatch{});
  int count = 0;
  for (std::size_t i = 0; i < size; ++i) {
    ObservationBatch& batch = batches[i / batch_size];
    const std::size_t k = i % batch_size;
    batch.limit[k] = options.limit_two;
    batch.point_z[k] = 1.0;
    if (!is_finite(problem, i)) continue;
    batch.point_x[k] = problem.points[i].x();
    batch.point_y[k] = problem.points[i].y();
    batch.point_z[k] = problem.points[i].z();
    batch.x[k] = problem.x[i];
    batch.y[k] = problem.y[i];
    batch.information[k] = problem.inverse_sigma2[i];
    if (!std::isnan(problem.right_x[i])) {
      batch.right_x[k] = problem.right_x[i];
      batch.information_right[k] = problem.inverse_sigma2[i];
      batch.limit[k] = options.limit_three;
    }
    batch.full_weight[k] = batch.weight[k] = std::max(0.0, static_cast<double>(problem.weight[i]));
    count += batch.weight[k] > 0.0;
  }
  return count;
}

/// Decides every observation anew at a pose. Returns whether the set that counts has changed.
bool decide(const Camera& camera, const Eigen::Isometry3d& pose, std::vector<ObservationBatch>& batches) {
  chi_squares(batches, PoseView(camera, pose));
  bool changed = false;
  for (ObservationBatch& batch : batches) {
    for (std::size_t k = 0; k < batch_size; ++k) {
      const double weight = batch.chi_square[k] <= batch.limit[k] ? batch.full_weight[k] : 0.0;
      changed |= weight != batch.weight[k];
      batch.weight[k] = weight;
    }
  }
  return changed;
}

/// One round of Levenberg-Marquardt. It ends when the predicted decrease is below `relative` times the cost and below
/// `absolute`; the decrease is half the squared number of standard deviations that the pose has still to go.
/// Returns the iterations spent; `system` belongs to the pose that is left in `pose`.
int minimise(const Camera& camera, const std::vector<ObservationBatch>& batches, bool robust, int iterations,
             double relative, double absolute, Eigen::Isometry3d& pose, PoseSystem& system) {
  double damping = 1e-7;
  build_system(batches, PoseView(camera, pose), robust, system);
  PoseSystem candidate;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    Matrix6d damped = system.hessian;
    damped.diagonal() *= 1.0 + damping;
    const Eigen::LDLT<Matrix6d> factor(damped);
    const Vector6d step = factor.solve(-system.gradient);
    if (factor.info() != Eigen::Success || !step.allFinite()) return iteration;
    const double predicted = -0.5 * system.gradient.dot(step);
    if (!(predicted > std::min(relative * system.cost, absolute) + 1e-14)) return iteration;
    const Eigen::Isometry3d moved = orthonormalised(exp_se3(step) * pose);
    build_system(batches, PoseView(camera, moved), robust, candidate);
    if (candidate.cost <= system.cost) {
      pose = moved;
      std::swap(system, candidate);
      damping = std::max(damping * 0.1, 1e-9);
    } else {
      damping = std::max(damping * 100.0, 1e-4);
    }
  }
  return iterations;
}

/// Whether the observations determine all six degrees of freedom; fills the covariance.
bool invert(const Matrix6d& hessian, Matrix6d& covariance) {
  const Vector6d scale = hessian.diagonal().cwiseMax(0.0).cwiseSqrt();
  if (!(scale.minCoeff() > 0.0) || !scale.allFinite()) return false;
  const Vector6d inverse_scale = scale.cwiseInverse();
  const Matrix6d scaled = inverse_scale.asDiagonal() * hessian * inverse_scale.asDiagonal();
  const Eigen::LLT<Matrix6d> factor(scaled);
  if (factor.info() != Eigen::Success || factor.rcond() < 1e-12) return false;
  covariance = inverse_scale.asDiagonal() * factor.solve(Matrix6d::Identity()) * inverse_scale.asDiagonal();
  return covariance.allFinite();
}

}  // namespace

PoseSummary adjust_pose(PoseProblem& problem, const PoseAdjustmentOptions& options) {
  const std::size_t size = problem.size();
  check_pose_problem(problem);
  thread_local std::vector<ObservationBatch> batches;  // reused, so that tracking does not allocate per frame
  PoseSummary summary;
  problem.inlier.assign(size, 0);
  if (pack(problem, options, batches) < 3 || !problem.T_camera_world.matrix().allFinite()) return summary;

  Eigen::Isometry3d pose = problem.T_camera_world;
  if (options.trust_guess) decide(*problem.camera, pose, batches);
  PoseSystem system;
  bool settled = false;  // the last round has been solved on the very set that it left behind
  for (int round = 0; round < options.robust_rounds + options.final_rounds; ++round) {
    const bool robust = round < options.robust_rounds;
    if (settled && round != options.robust_rounds) continue;
    // The robust rounds only have to tell outliers from the rest.
    const double relative = robust ? 1e-4 : 1e-8, absolute = robust ? 0.02 : 1e-4;
    summary.iterations +=
        minimise(*problem.camera, batches, robust, options.iterations, relative, absolute, pose, system);
    settled = !decide(*problem.camera, pose, batches);
  }

  int inliers = 0;
  for (std::size_t i = 0; i < size; ++i) inliers += batches[i / batch_size].weight[i % batch_size] > 0.0;
  if (inliers < 3 || !pose.matrix().allFinite() || !invert(system.hessian, summary.covariance)) return summary;

  for (std::size_t i = 0; i < size; ++i) {
    const ObservationBatch& batch = batches[i / batch_size];
    problem.inlier[i] = is_finite(problem, i) && batch.chi_square[i % batch_size] <= batch.limit[i % batch_size];
  }
  problem.T_camera_world = pose;
  summary.usable = true;
  summary.inliers = inliers;
  summary.final_cost = system.cost;
  return summary;
}

}  // namespace holdfast::geometry
