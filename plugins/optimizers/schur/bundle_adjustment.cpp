// SPDX-License-Identifier: BSD-3-Clause
#include "bundle_adjustment.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>

#include "holdfast/geometry/se3.hpp"

namespace holdfast::schur_plugin {

namespace {

using PoseMatrix = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

Eigen::Isometry3d pose_at(const double* numbers) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.matrix().topRows<3>() = Eigen::Map<const PoseMatrix>(numbers);
  return pose;
}

}  // namespace

BundleSummary BundleAdjuster::run(BundleProblem& problem, const std::atomic<bool>& stop) {
  const auto start = std::chrono::steady_clock::now();
  BundleSummary summary;
  selection_.select(problem);
  if (stop.load(std::memory_order_relaxed)) {
    summary.stopped = true;
    return summary;
  }
  camera_ = problem.camera;
  const bool own = problem.function_tolerance > 0.0;
  function_tolerance_ = own ? problem.function_tolerance : settings_.function_tolerance;
  step_tolerance_ = own ? 0.0 : settings_.step_tolerance;
  stops_early_ = !own;
  arrays_.build(problem, selection_);
  if (arrays_.free_count() == 0 && problem.factors.empty()) return summary;
  if (!take_factors(problem)) {
    factors_.end();
    return summary;
  }
  build_system();
  damping_ = Damping();
  summary.initial_cost = current_cost(true);
  summary.final_cost = minimise(problem.robust_iterations, true, stop, summary);
  if (!summary.stopped && problem.final_iterations > 0) {
    find_outliers(problem);
    arrays_.leave_out(problem, outliers_);
    build_system();
    summary.final_cost = minimise(problem.final_iterations, false, stop, summary);
  }
  if (std::isfinite(summary.final_cost)) summary.usable = write(problem, summary);
  factors_.end();
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return summary;
}

bool BundleAdjuster::take_factors(const BundleProblem& problem) {
  factors_.end();
  if (problem.factors.empty()) return true;
  if (!factors_.begin(problem, std::span(arrays_.pose_indices).first(arrays_.free_count()))) return false;
  return !factors_.empty() || arrays_.free_count() > 0;
}

void BundleAdjuster::build_system() {
  const std::size_t free = arrays_.free_count();
  const auto for_each_pair = [this](auto&& function) {
    for (std::size_t point = 0; point < arrays_.point_count(); ++point) {
      const std::int32_t* pose = arrays_.pose.data() + lanes * arrays_.first_group[point];
      const std::uint32_t count = arrays_.first_coupling[point + 1] - arrays_.first_coupling[point];
      for (std::uint32_t a = 0; a < count; ++a)
        for (std::uint32_t b = 0; b <= a; ++b)
          function(static_cast<std::size_t>(pose[a]), static_cast<std::size_t>(pose[b]));
    }
  };
  const bool dense = free <= static_cast<std::size_t>(settings_.dense_poses);
  system_.begin_structure(free, dense);
  if (!dense) for_each_pair([this](std::size_t row, std::size_t column) { system_.add_block(row, column); });
  system_.finish_structure();
  pair_block_.clear();
  pair_block_.reserve(arrays_.first_pair.back());
  for_each_pair([this](std::size_t row, std::size_t column) { pair_block_.push_back(system_.block(row, column)); });

  cameras_.resize(camera_size * free);
  camera_damping_.resize(6 * free);
  couplings_.resize(coupling_size * arrays_.first_coupling.back());
  eliminations_.resize(elimination_size * arrays_.point_count());
  scratch_.resize(arrays_.group_count_of_largest_point());
  steps_.resize(coupling_size * free);
  right_hand_side_.resize(static_cast<Eigen::Index>(6 * free));
  moved_poses_ = arrays_.poses;
  moved_points_ = arrays_.points;
}

BundleView BundleAdjuster::view(bool is_robust) const {
  BundleView view = arrays_.view();
  view.fx = camera_->fx, view.fy = camera_->fy, view.cx = camera_->cx, view.cy = camera_->cy;
  view.baseline = camera_->baseline;
  view.chi_square_2d = settings_.chi_square_two, view.chi_square_3d = settings_.chi_square_three;
  view.disparity_scale = 1.0 / settings_.disparity_sigma;
  view.disparity_limit = settings_.disparity_threshold * settings_.disparity_threshold;
  view.is_robust = is_robust;
  return view;
}

double BundleAdjuster::current_cost(bool is_robust) {
  const double cost = kernels_.cost(view(is_robust), nullptr);
  return factors_.empty() ? cost : cost + factors_.cost(arrays_.poses.data());
}

double BundleAdjuster::moved_cost(bool is_robust) {
  BundleView moved = view(is_robust);
  moved.poses = moved_poses_.data();
  moved.points = moved_points_.data();
  const double cost = kernels_.cost(moved, nullptr);
  return factors_.empty() ? cost : cost + factors_.moved_cost(moved_poses_.data());
}

double BundleAdjuster::minimise(int iterations, bool is_robust, const std::atomic<bool>& stop, BundleSummary& summary) {
  double cost = current_cost(is_robust);
  // Where no pose is free, factors move motions and the world alone, which a damped step hardly reaches.
  const bool has_poses = factors_.empty() || arrays_.free_count() > 0;
  for (int i = 0; i < iterations; ++i) {
    if (stop.load(std::memory_order_relaxed)) {
      summary.stopped = true;
      return cost;
    }
    ++summary.iterations;
    const double damping = damping_.value();
    double predicted = 0.0, pose_step = 0.0;
    if (!find_step(view(is_robust), predicted, pose_step)) {
      damping_.refuse();
      if (damping_.is_hopeless()) return cost;
      continue;
    }
    const double cost_after = moved_cost(is_robust);
    const double decrease = cost - cost_after;
    const bool accepted = decrease > minimum_gain * predicted && predicted > 0.0;
    if (accepted) {
      arrays_.poses.swap(moved_poses_);
      arrays_.points.swap(moved_points_);
      factors_.accept();
      damping_.accept(decrease / predicted);
      cost = cost_after;
    } else {
      damping_.refuse();
      if (damping_.is_hopeless()) return cost;
    }
    // The first phase only prepares the second one.
    const double tolerance = function_tolerance_ * cost * (stops_early_ && is_robust ? 10.0 : 1.0);
    if (std::abs(decrease) <= tolerance || (has_poses && pose_step <= step_tolerance_)) return cost;
    // If the linearisation foresaw the decrease to within the tolerance, its minimum, which a step with little damping
    // reaches, is that of the cost.
    if (stops_early_ && has_poses && damping <= Damping().value() && std::abs(decrease - predicted) <= tolerance)
      return cost;
  }
  return cost;
}

bool BundleAdjuster::find_step(const BundleView& view, double& predicted_decrease, double& pose_step) {
  system_.set_zero();
  std::fill(cameras_.begin(), cameras_.end(), 0.0);
  const BundleSystem system{pair_block_.data(), system_.elements(0),  cameras_.data(),
                            couplings_.data(),  eliminations_.data(), scratch_.data()};
  kernels_.eliminate(view, damping_.value(), system);
  if (!factors_.empty()) factors_.linearise(arrays_.poses.data());
  add_camera_diagonal();
  predicted_decrease = 0.0;
  pose_step = 0.0;
  if (!(factors_.empty() ? system_.solve(right_hand_side_)
                         : factors_.solve(system_, damping_.value(), right_hand_side_, predicted_decrease)))
    return false;
  for (std::size_t i = 0; i < arrays_.free_count(); ++i) {
    const double* gradient = cameras_.data() + camera_size * i + block_size;
    const double* step = right_hand_side_.data() + 6 * i;
    for (std::size_t k = 0; k < 6; ++k) {
      const double slope = factors_.empty() ? gradient[k] : gradient[k] + factors_.gradient(6 * i + k);
      predicted_decrease += 0.5 * (camera_damping_[6 * i + k] * step[k] * step[k] - slope * step[k]);
      pose_step = std::max(pose_step, std::abs(step[k]));
    }
    double* repeated = steps_.data() + coupling_size * i;
    for (std::size_t k = 0; k < coupling_size; ++k) repeated[k] = step[k % 6];
  }
  predicted_decrease += kernels_.substitute(view, system, steps_.data(), moved_points_.data());
  move_poses();
  return std::isfinite(predicted_decrease);
}

void BundleAdjuster::add_camera_diagonal() {
  for (std::size_t i = 0; i < arrays_.free_count(); ++i) {
    const double* hessian = cameras_.data() + camera_size * i;
    const double* reduced_gradient = hessian + block_size + 6;
    double* block = system_.elements(system_.block(i, i));
    for (std::size_t k = 0; k < block_size; ++k) block[k] += hessian[k];
    for (std::size_t k = 0; k < 6; ++k) {
      const auto number = static_cast<Eigen::Index>(6 * i + k);
      double diagonal = hessian[7 * k];
      right_hand_side_[number] = -reduced_gradient[k];
      if (!factors_.empty()) {
        diagonal += factors_.diagonal(6 * i + k);
        right_hand_side_[number] -= factors_.gradient(6 * i + k);
      }
      camera_damping_[6 * i + k] = damping_.value() * std::clamp(diagonal, 1e-6, 1e32);
      block[7 * k] += camera_damping_[6 * i + k];
    }
  }
}

void BundleAdjuster::move_poses() {
  for (std::size_t i = 0; i < arrays_.free_count(); ++i) {
    const geometry::Vector6d step = right_hand_side_.segment<6>(static_cast<Eigen::Index>(6 * i));
    const Eigen::Isometry3d pose = geometry::exp_se3(step) * pose_at(arrays_.poses.data() + pose_size * i);
    Eigen::Map<PoseMatrix>(moved_poses_.data() + pose_size * i) = pose.matrix().topRows<3>();
  }
}

void BundleAdjuster::find_outliers(const BundleProblem& problem) {
  chi_squares_.resize(arrays_.entry_count());
  kernels_.cost(view(false), chi_squares_.data());
  const ChiSquareLimits limits{settings_.chi_square_two, settings_.chi_square_three};
  outliers_.assign(arrays_.entry_count(), 0);
  for (std::size_t i = 0; i < outliers_.size(); ++i) {
    if (arrays_.entries[i] == BundleArrays::none) continue;
    outliers_[i] = !(chi_squares_[i] <= limits.of(problem.observations[arrays_.entries[i]]));
  }
}

bool BundleAdjuster::write(BundleProblem& problem, BundleSummary& summary) {
  const auto finite = [](double value) { return std::isfinite(value); };
  if (!std::all_of(arrays_.poses.begin(), arrays_.poses.end(), finite) ||
      !std::all_of(arrays_.points.begin(), arrays_.points.end(), finite))
    return false;
  if (!factors_.empty() && !factors_.write(problem)) return false;
  for (std::size_t i = 0; i < arrays_.free_count(); ++i)
    problem.poses[arrays_.pose_indices[i]].T_camera_world =
        geometry::orthonormalised(pose_at(arrays_.poses.data() + pose_size * i));
  for (std::size_t i = 0; i < arrays_.point_count(); ++i)
    problem.points[arrays_.point_indices[i]] = Eigen::Map<const Eigen::Vector3d>(arrays_.points.data() + 3 * i);
  const ChiSquareLimits limits{settings_.chi_square_two, settings_.chi_square_three};
  for (BundleProblem::Observation& observation : problem.observations) {
    observation.outlier = is_outlier(*problem.camera, problem.poses[observation.pose].T_camera_world,
                                     problem.points[observation.point], observation, limits);
    summary.outliers += observation.outlier;
  }
  return true;
}

}  // namespace holdfast::schur_plugin
