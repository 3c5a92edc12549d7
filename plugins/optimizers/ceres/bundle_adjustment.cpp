// SPDX-License-Identifier: BSD-3-Clause
#include "bundle_adjustment.hpp"

#include <ceres/iteration_callback.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <chrono>
#include <deque>

#include "factor_cost.hpp"
#include "holdfast/core/check.hpp"
#include "holdfast/interfaces/bundle_selection.hpp"
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

/// One bundle adjustment: owns everything that the Ceres problem points to.
class Bundle {
 public:
  Bundle(BundleProblem& problem, const CeresSettings& settings)
      : problem_(problem),
        settings_(settings),
        limits_{settings.chi_square_two, settings.chi_square_three},
        camera_(*problem.camera),
        evaluation_(problem),
        updater_(states_, parameters_) {}

  BundleSummary run(const std::atomic<bool>& stop);

 private:
  using Observation = BundleProblem::Observation;

  void choose();
  void build();
  void add_free(const Observation& observation);
  void add_factor(const FactorEvaluation::Factor& factor);
  Measurement measurement_of(const Observation& observation) const;
  void set_outliers_aside();
  bool is_an_outlier(const Observation& observation) const {
    return is_outlier(camera_, states_[observation.pose].exact(), points_[observation.point], observation, limits_);
  }
  /// Runs the solver; returns whether its result can be used.
  bool solve(int iterations, const std::atomic<bool>& stop, BundleSummary& summary, double& cost_before);

  BundleProblem& problem_;
  const CeresSettings& settings_;
  const ChiSquareLimits limits_;
  const Camera camera_;
  const FactorEvaluation evaluation_;
  std::vector<PoseState> states_;
  FactorParameters parameters_;
  StateUpdater updater_;
  std::vector<Eigen::Vector3d> points_;
  BundleSelection selection_;
  std::vector<std::uint32_t> free_;   // observations in the problem, from free poses
  std::vector<std::uint32_t> fixed_;  // from fixed poses, by point
  bool is_robust_ = true;
  // What the problem points to; reserved, so that references stay valid.
  std::vector<Measurement> measurements_;             // of free_
  std::vector<SwitchableHuber> losses_;               // of free_
  std::vector<FixedObservation> fixed_observations_;  // of fixed_
  std::deque<FreePoseCost<2>> free_two_;
  std::deque<FreePoseCost<3>> free_three_;
  std::deque<FixedPosesCost> fixed_costs_;
  std::deque<FactorCost> factor_costs_;
  std::unique_ptr<ceres::Problem> ceres_;
};

void Bundle::choose() {
  selection_.select(problem_);
  for (std::size_t i = 0; i < problem_.observations.size(); ++i) {
    if (!selection_.observation_counts[i]) continue;
    const bool is_fixed = problem_.poses[problem_.observations[i].pose].fixed;
    (is_fixed ? fixed_ : free_).push_back(static_cast<std::uint32_t>(i));
  }
  std::stable_sort(fixed_.begin(), fixed_.end(), [this](std::uint32_t a, std::uint32_t b) {
    return problem_.observations[a].point < problem_.observations[b].point;
  });
}

Measurement Bundle::measurement_of(const Observation& observation) const {
  const double weight = observation.weight;
  return {.x = observation.x,
          .y = observation.y,
          .disparity = static_cast<double>(observation.x) - observation.right_x,
          .scale = std::sqrt(observation.inverse_sigma2 * weight),
          .disparity_scale = std::sqrt(weight) / settings_.disparity_sigma,
          .disparity_threshold = std::sqrt(weight) * settings_.disparity_threshold};
}

void Bundle::add_free(const Observation& observation) {
  PoseState& pose = states_[observation.pose];
  double* point = points_[observation.point].data();
  const Measurement& measurement = measurements_.emplace_back(measurement_of(observation));
  SwitchableHuber* loss = &losses_.emplace_back(limits_.of(observation) * observation.weight, is_robust_);
  ceres::CostFunction* cost = nullptr;
  if (std::isnan(observation.right_x))
    cost = &free_two_.emplace_back(camera_, measurement, pose);
  else
    cost = &free_three_.emplace_back(camera_, measurement, pose);
  ceres_->AddResidualBlock(cost, loss, pose.parameters, point);
}

void Bundle::add_factor(const FactorEvaluation::Factor& factor) {
  constexpr std::uint32_t none = FactorEvaluation::none;
  const std::array<bool, 3> world_moves = evaluation_.world_moves();
  FactorCost::Free free{};
  std::vector<double*> blocks;
  for (std::size_t i = 0; i < 2; ++i) {
    free[i] = factor.poses[i] != none && !problem_.poses[factor.poses[i]].fixed;
    if (free[i]) blocks.push_back(states_[factor.poses[i]].parameters);
  }
  for (std::size_t i = 0; i < 2; ++i) {
    free[2 + i] = factor.motions[i] != none && evaluation_.motion_moves(factor.motions[i]);
    if (free[2 + i]) blocks.push_back(parameters_.motions[factor.motions[i]].data());
  }
  free[4] = factor.has_world && (world_moves[0] || world_moves[2]);
  if (free[4]) blocks.push_back(parameters_.world.data());
  ceres_->AddResidualBlock(&factor_costs_.emplace_back(evaluation_, factor, parameters_.states, states_, free), nullptr,
                           blocks);
}

void Bundle::build() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  options.evaluation_callback = &updater_;
  ceres_ = std::make_unique<ceres::Problem>(options);
  measurements_.reserve(free_.size());
  losses_.reserve(free_.size());
  for (const std::uint32_t i : free_) add_free(problem_.observations[i]);

  fixed_observations_.reserve(fixed_.size());
  for (std::size_t begin = 0, end = 0; begin < fixed_.size(); begin = end) {
    const std::uint32_t point = problem_.observations[fixed_[begin]].point;
    for (; end < fixed_.size() && problem_.observations[fixed_[end]].point == point; ++end) {
      const Observation& observation = problem_.observations[fixed_[end]];
      fixed_observations_.push_back({measurement_of(observation), &states_[observation.pose],
                                     limits_.of(observation) * observation.weight, !std::isnan(observation.right_x)});
    }
    const std::span<const FixedObservation> group(fixed_observations_.data() + begin, end - begin);
    ceres_->AddResidualBlock(&fixed_costs_.emplace_back(camera_, group, is_robust_), nullptr, points_[point].data());
  }
  for (const FactorEvaluation::Factor& factor : evaluation_.factors()) add_factor(factor);
}

void Bundle::set_outliers_aside() {
  for (std::size_t i = 0; i < free_.size(); ++i)
    measurements_[i].active = !is_an_outlier(problem_.observations[free_[i]]);
  for (std::size_t i = 0; i < fixed_.size(); ++i)
    fixed_observations_[i].measurement.active = !is_an_outlier(problem_.observations[fixed_[i]]);
  is_robust_ = false;
}

bool Bundle::solve(int iterations, const std::atomic<bool>& stop, BundleSummary& summary, double& cost_before) {
  ceres::Solver::Options options;
  // The groups are sets of addresses; each group stands in one array, so that its order is that of the problem.
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  int free_poses = 0;
  for (std::size_t i = 0; i < points_.size(); ++i)
    if (selection_.point_counts[i]) ordering->AddElementToGroup(points_[i].data(), 0);
  for (std::size_t i = 0; i < states_.size(); ++i)
    if (selection_.pose_moves[i]) ordering->AddElementToGroup(states_[i].parameters, 1), ++free_poses;
  for (std::size_t i = 0; i < parameters_.motions.size(); ++i)
    if (evaluation_.motion_moves(i)) ordering->AddElementToGroup(parameters_.motions[i].data(), 2);
  if (ceres_->HasParameterBlock(parameters_.world.data())) ordering->AddElementToGroup(parameters_.world.data(), 3);
  options.linear_solver_ordering = std::move(ordering);
  options.linear_solver_type = free_poses <= settings_.dense_poses ? ceres::DENSE_SCHUR : ceres::SPARSE_SCHUR;
  if (free_.empty()) options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;  // no point to eliminate
  // CHOLMOD starts threads of its own through OpenMP and BLAS, whatever num_threads says.
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options.max_num_iterations = iterations;
  options.function_tolerance =
      problem_.function_tolerance > 0.0 ? problem_.function_tolerance : settings_.function_tolerance;
  options.jacobi_scaling = false;  // the damping is scaled by the columns anyway
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  StopCallback callback(stop);
  options.callbacks.push_back(&callback);
  ceres::Solver::Summary result;
  ceres::Solve(options, ceres_.get(), &result);
  for (PoseState& state : states_) state.update();
  parameters_.update(states_);
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
  if (!evaluation_.factors().empty()) {
    parameters_.states = evaluation_.states();
    parameters_.motions = parameters_.states.motions;
  }
  choose();
  if (stop.load(std::memory_order_relaxed)) {
    summary.stopped = true;
    return summary;
  }
  if (free_.empty() && evaluation_.factors().empty()) return summary;
  if (!evaluation_.is_finite()) return summary;
  build();
  if (!solve(problem_.robust_iterations, stop, summary, summary.initial_cost)) return summary;
  if (!summary.stopped && problem_.final_iterations > 0) {
    set_outliers_aside();
    double ignored = 0.0;
    if (!solve(problem_.final_iterations, stop, summary, ignored)) return summary;
  }
  for (std::size_t i = 0; i < states_.size(); ++i)
    if (selection_.pose_moves[i] && !states_[i].T_camera_world().matrix().allFinite()) return summary;

  for (std::size_t i = 0; i < parameters_.motions.size(); ++i)
    if (!parameters_.motions[i].allFinite() && evaluation_.motion_moves(i)) return summary;
  if (!parameters_.world.allFinite()) return summary;

  for (Observation& observation : problem_.observations) {
    observation.outlier = is_an_outlier(observation);
    summary.outliers += observation.outlier;
  }
  for (std::size_t i = 0; i < states_.size(); ++i)
    if (selection_.pose_moves[i]) problem_.poses[i].T_camera_world = states_[i].T_camera_world();
  problem_.points = std::move(points_);
  evaluation_.write(parameters_.states, problem_);
  summary.usable = true;
  return summary;
}

}  // namespace

BundleSummary adjust_bundle(BundleProblem& problem, const std::atomic<bool>& stop, const CeresSettings& settings) {
  const auto start = std::chrono::steady_clock::now();
  HOLDFAST_CHECK(problem.camera != nullptr, "a bundle problem needs a camera");
  BundleSummary summary = Bundle(problem, settings).run(stop);
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return summary;
}

}  // namespace holdfast::ceres_plugin
