// SPDX-License-Identifier: BSD-3-Clause
#include "bundle_adjustment.hpp"

#include <ceres/iteration_callback.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <limits>

#include "holdfast/core/error.hpp"
#include "observation_cost.hpp"

namespace holdfast::ceres_plugin {
namespace {

class StopCallback final : public ceres::IterationCallback {
 public:
  explicit StopCallback(const std::atomic<bool>& stop) : stop_(stop) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    return stop_.load(std::memory_order_relaxed) ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  const std::atomic<bool>& stop_;
};

void check(const BundleProblem& problem) {
  HOLDFAST_CHECK(problem.camera != nullptr, "a bundle problem needs a camera");
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    const BundleProblem::Observation& observation = problem.observations[i];
    HOLDFAST_CHECK(observation.pose < problem.poses.size() && observation.point < problem.points.size(),
                   "observation " << i << " pose " << observation.pose << " of " << problem.poses.size() << " point "
                                  << observation.point << " of " << problem.points.size());
  }
}

bool is_finite(const BundleProblem::Observation& observation) {
  return std::isfinite(observation.x) && std::isfinite(observation.y) && !std::isinf(observation.right_x) &&
         std::isfinite(observation.inverse_sigma2) && std::isfinite(observation.weight) &&
         observation.inverse_sigma2 > 0.0f;
}

/// One bundle adjustment: owns everything that the Ceres problem points to.
class Bundle {
 public:
  Bundle(BundleProblem& problem, const CeresSettings& settings)
      : problem_(problem), settings_(settings), camera_(*problem.camera), updater_(states_) {}

  BundleSummary run(const std::atomic<bool>& stop);

 private:
  using Observation = BundleProblem::Observation;

  void choose();
  void build();
  template <int rows>
  void add(std::size_t index, ceres::LossFunction* loss);
  bool is_outlier(const Observation& observation) const;
  double limit(const Observation& observation) const {
    return std::isnan(observation.right_x) ? settings_.chi_square_two : settings_.chi_square_three;
  }
  /// Runs the solver; returns whether its result can be used.
  bool solve(int iterations, const std::atomic<bool>& stop, BundleSummary& summary, double& cost_before);

  BundleProblem& problem_;
  const CeresSettings& settings_;
  const Camera camera_;
  std::vector<PoseState> states_;
  PoseUpdater updater_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<std::uint32_t> chosen_;  // observations in the problem
  std::vector<std::uint8_t> pose_is_used_, point_is_used_;
  std::vector<Measurement> measurements_;  // of chosen_
  std::vector<SwitchableHuber> losses_;    // of chosen_
  // Pools: one block of memory each rather than one per observation. References stay valid as they grow.
  std::deque<FreePoseCost<2>> free_two_;
  std::deque<FreePoseCost<3>> free_three_;
  std::deque<FixedPoseCost<2>> fixed_two_;
  std::deque<FixedPoseCost<3>> fixed_three_;
  std::unique_ptr<ceres::Problem> ceres_;
};

/// Squared residual over its variance; infinite behind the camera, NaN for what is not finite.
double chi_square(const Camera& camera, const PoseState& pose, const Eigen::Vector3d& point,
                  const BundleProblem::Observation& observation) {
  const Eigen::Vector3d p = pose.rotation * point + pose.translation;
  if (!(p.z() > geometry::minimum_depth)) return std::numeric_limits<double>::infinity();
  const Eigen::Vector2d pixel = camera.project(p);
  double squared = (pixel - Eigen::Vector2d(observation.x, observation.y)).squaredNorm();
  if (!std::isnan(observation.right_x)) {
    const double right = camera.right_x(pixel.x(), p.z()) - observation.right_x;
    squared += right * right;
  }
  return squared * observation.inverse_sigma2;
}

bool Bundle::is_outlier(const Observation& observation) const {
  return !is_finite(observation) || !(chi_square(camera_, states_[observation.pose], points_[observation.point],
                                                 observation) <= limit(observation));
}

void Bundle::choose() {
  const std::size_t count = problem_.observations.size();
  std::vector<std::uint8_t> usable(count);
  std::vector<int> rows(points_.size());
  point_is_used_.assign(points_.size(), 0);
  pose_is_used_.assign(states_.size(), 0);
  for (std::size_t i = 0; i < count; ++i) {
    const Observation& observation = problem_.observations[i];
    const double chi = chi_square(camera_, states_[observation.pose], points_[observation.point], observation);
    if (!is_finite(observation) || observation.weight <= 0.0f || !std::isfinite(chi)) continue;
    usable[i] = 1;
    rows[observation.point] += std::isnan(observation.right_x) ? 2 : 3;
    if (!problem_.poses[observation.pose].fixed) point_is_used_[observation.point] = 1;
  }
  for (std::size_t i = 0; i < points_.size(); ++i) point_is_used_[i] = point_is_used_[i] && rows[i] >= 3;
  for (std::size_t i = 0; i < count; ++i) {
    const Observation& observation = problem_.observations[i];
    if (!usable[i] || !point_is_used_[observation.point]) continue;
    chosen_.push_back(static_cast<std::uint32_t>(i));
    if (!problem_.poses[observation.pose].fixed) pose_is_used_[observation.pose] = 1;
  }
}

template <int rows>
void Bundle::add(std::size_t index, ceres::LossFunction* loss) {
  const Observation& observation = problem_.observations[chosen_[index]];
  PoseState& pose = states_[observation.pose];
  double* point = points_[observation.point].data();
  if (problem_.poses[observation.pose].fixed) {
    if constexpr (rows == 2)
      ceres_->AddResidualBlock(&fixed_two_.emplace_back(camera_, measurements_[index], pose), loss, point);
    else
      ceres_->AddResidualBlock(&fixed_three_.emplace_back(camera_, measurements_[index], pose), loss, point);
  } else {
    if constexpr (rows == 2)
      ceres_->AddResidualBlock(&free_two_.emplace_back(camera_, measurements_[index], pose), loss, pose.parameters,
                               point);
    else
      ceres_->AddResidualBlock(&free_three_.emplace_back(camera_, measurements_[index], pose), loss, pose.parameters,
                               point);
  }
}

void Bundle::build() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  options.evaluation_callback = &updater_;
  ceres_ = std::make_unique<ceres::Problem>(options);
  measurements_.resize(chosen_.size());
  losses_.reserve(chosen_.size());
  for (std::size_t i = 0; i < chosen_.size(); ++i) {
    const Observation& observation = problem_.observations[chosen_[i]];
    const double scale2 = static_cast<double>(observation.inverse_sigma2) * observation.weight;
    measurements_[i] = {observation.x, observation.y, observation.right_x, std::sqrt(scale2), true};
    losses_.emplace_back(limit(observation) * observation.weight);
    if (std::isnan(observation.right_x))
      add<2>(i, &losses_.back());
    else
      add<3>(i, &losses_.back());
  }
}

bool Bundle::solve(int iterations, const std::atomic<bool>& stop, BundleSummary& summary, double& cost_before) {
  ceres::Solver::Options options;
  // The groups are sets of addresses; poses and points stand in one array each, so their order is that of the problem.
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  int free_poses = 0;
  for (std::size_t i = 0; i < points_.size(); ++i)
    if (point_is_used_[i]) ordering->AddElementToGroup(points_[i].data(), 0);
  for (std::size_t i = 0; i < states_.size(); ++i)
    if (pose_is_used_[i]) ordering->AddElementToGroup(states_[i].parameters, 1), ++free_poses;
  options.linear_solver_ordering = std::move(ordering);
  options.linear_solver_type = free_poses <= settings_.dense_poses ? ceres::DENSE_SCHUR : ceres::SPARSE_SCHUR;
  options.max_num_iterations = iterations;
  options.function_tolerance = settings_.function_tolerance;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  StopCallback callback(stop);
  options.callbacks.push_back(&callback);
  ceres::Solver::Summary result;
  ceres::Solve(options, ceres_.get(), &result);
  for (PoseState& state : states_) state.update();
  summary.iterations += std::max(0, static_cast<int>(result.iterations.size()) - 1);
  summary.final_cost = result.final_cost;
  summary.stopped = result.termination_type == ceres::USER_SUCCESS;
  cost_before = result.initial_cost;
  return result.IsSolutionUsable() && std::isfinite(result.final_cost);
}

BundleSummary Bundle::run(const std::atomic<bool>& stop) {
  BundleSummary summary;
  states_.resize(problem_.poses.size());
  for (std::size_t i = 0; i < states_.size(); ++i) states_[i].set(problem_.poses[i].T_camera_world);
  points_ = problem_.points;
  choose();
  if (stop.load(std::memory_order_relaxed)) {
    summary.stopped = true;
    return summary;
  }
  if (chosen_.empty()) return summary;
  build();
  if (!solve(problem_.robust_iterations, stop, summary, summary.initial_cost)) return summary;
  if (!summary.stopped && problem_.final_iterations > 0) {
    for (std::size_t i = 0; i < chosen_.size(); ++i)
      measurements_[i].active = !is_outlier(problem_.observations[chosen_[i]]);
    for (SwitchableHuber& loss : losses_) loss.lift();
    double ignored = 0.0;
    if (!solve(problem_.final_iterations, stop, summary, ignored)) return summary;
  }
  for (std::size_t i = 0; i < states_.size(); ++i)
    if (pose_is_used_[i] && !states_[i].T_camera_world().matrix().allFinite()) return summary;

  for (Observation& observation : problem_.observations) {
    observation.outlier = is_outlier(observation);
    summary.outliers += observation.outlier;
  }
  for (std::size_t i = 0; i < states_.size(); ++i)
    if (pose_is_used_[i]) problem_.poses[i].T_camera_world = states_[i].T_camera_world();
  problem_.points = std::move(points_);
  summary.usable = true;
  return summary;
}

}  // namespace

BundleSummary adjust_bundle(BundleProblem& problem, const std::atomic<bool>& stop, const CeresSettings& settings) {
  const auto start = std::chrono::steady_clock::now();
  check(problem);
  BundleSummary summary = Bundle(problem, settings).run(stop);
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return summary;
}

}  // namespace holdfast::ceres_plugin
