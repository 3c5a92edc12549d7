// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/metric_scale.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "frame_chains.hpp"
#include "holdfast/core/imu_timeline.hpp"
#include "holdfast/tracking/inertial_start_search.hpp"

namespace holdfast {

namespace {

constexpr double window_spacing = 0.2, least_window_time = 5.0;  // [s]
constexpr std::size_t most_window_poses = 100, most_windows = 4;
constexpr double smallest_pose_deviation = 0.001;  // [m]
constexpr double largest_window_deviation = 0.1;   // of the scale of the start, relative
constexpr double largest_scale_deviation = 0.01;   // of the scale, relative

/// The trajectory at intervals, in a few windows that measurements link, of at most `most_window_poses` poses.
std::vector<Trajectory> find_windows(const Trajectory& trajectory, const InertialHistory& inertia) {
  std::vector<double> stamps;
  Trajectory poses;
  for (const TimedPose& pose : trajectory) {
    if (!stamps.empty() && pose.timestamp - stamps.back() < window_spacing) continue;
    stamps.push_back(pose.timestamp);
    poses.push_back(pose);
  }
  std::vector<Trajectory> windows;
  std::size_t last = std::numeric_limits<std::size_t>::max();
  for (const InertialHistory::Link& link : inertia.links(stamps, inertia.nominal())) {
    if (link.first != last || windows.back().size() == most_window_poses) windows.push_back({poses[link.first]});
    windows.back().push_back(poses[link.second]);
    last = link.second;
  }
  std::erase_if(windows, [](const Trajectory& window) {
    return window.back().timestamp - window.front().timestamp < least_window_time;
  });
  if (windows.size() <= most_windows) return windows;
  std::vector<Trajectory> chosen;  // evenly
  for (std::size_t i = 0; i < most_windows; ++i)
    chosen.push_back(std::move(windows[i * windows.size() / most_windows]));
  return chosen;
}

/// Estimates of the window that determines the scale best.
std::optional<MapInertia> start_by_trajectory(const Trajectory& trajectory, const InertialHistory& inertia) {
  InertialStartSearch search;
  search.estimate_scale = true;
  search.smallest_deviation = smallest_pose_deviation;
  search.largest_scale_deviation = largest_window_deviation;
  // A scale that is as uncertain leaves velocities and gravity uncertain, too.
  search.largest_direction_deviation = search.largest_velocity_deviation = std::numeric_limits<double>::infinity();
  std::optional<MapInertia> best;
  for (const Trajectory& window : find_windows(trajectory, inertia)) {
    const std::vector<ImuSample> samples =
        covering(inertia.samples(), window.front().timestamp, window.back().timestamp, inertia.imu());
    const std::optional<FoundInertialStart> found = find_inertial_start(window, samples, inertia.imu(), search);
    if (!found) continue;
    const geometry::InertialStart& start = found->start;
    search.largest_scale_deviation = start.scale_deviation;
    best = inertia.nominal();
    best->gravity = start.gravity;
    best->scale = start.scale;
    best->bias = start.bias;
    best->mounting = start.mounting;
    best->time_offset = start.time_offset;
    best->gravity_deviation = start.direction_deviation;
    best->gyroscope_deviation = start.gyroscope_bias_deviation;
    best->accelerometer_deviation = start.accelerometer_bias_deviation;
    best->mounting_deviation = nominal_mounting_deviation;
    best->time_offset_deviation = nominal_time_offset_deviation;
    best->position_deviation = found->deviations.position;
    best->rotation_deviation = found->deviations.rotation;
  }
  return best;
}

/// Relative standard deviation of the scale of a solution: by the increase of the cost where another scale is fixed,
/// times the root of the mean squared residual if that is larger than 1. Empty if a problem has no solution.
std::optional<double> deviation_of_scale(const BundleProblem& solution, Optimizer& optimizer,
                                         const std::atomic<bool>& stop) {
  constexpr double step = 0.01;
  bool is_usable = true;
  const auto cost_at = [&](double factor) {
    BundleProblem problem = solution;
    problem.factors.scale *= factor, problem.factors.scale_fixed = true;
    const BundleSummary summary = optimizer.optimize_bundle(problem, stop);
    is_usable = is_usable && summary.usable && !stop;
    return summary.final_cost;
  };
  // The solution converges further as the others do.
  const double cost = cost_at(1.0), larger = cost_at(std::exp(step)), smaller = cost_at(std::exp(-step));
  const double increase = 0.5 * (larger + smaller) - cost;
  if (!is_usable || !(increase > 0.0)) return std::nullopt;
  const BundleFactors& factors = solution.factors;
  const double residuals = 6.0 * static_cast<double>(factors.pose_priors.size() + factors.motion_priors.size()) +
                           15.0 * static_cast<double>(factors.inertial.size());
  constexpr double direction_and_scale = 3.0;
  const double unknowns = 6.0 * static_cast<double>(solution.poses.size()) +
                          9.0 * static_cast<double>(factors.motions.size()) + direction_and_scale;
  const double mean_chi_square = 2.0 * cost / std::max(1.0, residuals - unknowns);
  return step / std::sqrt(2.0 * increase) * std::sqrt(std::max(1.0, mean_chi_square));
}

}  // namespace

std::optional<ScaleEstimate> estimate_scale(const RunPath& path, const UnplacedFrames& unplaced,
                                            const InertialHistory& inertia, const MapInertia& estimates,
                                            Optimizer& optimizer, const std::atomic<bool>& stop) {
  if (!path.camera) return std::nullopt;
  const FrameChains frames(path, unplaced, inertia, estimates, 1.0, true);
  struct Estimate {
    double logarithm, weight;
    Eigen::Vector3d gravity;
  };
  std::vector<Estimate> found;
  double information = 0.0, logarithm = 0.0;
  for (const FrameChain& chain : frames.find()) {
    const std::optional<BundleProblem> solution = frames.solve(chain, optimizer, stop);
    if (stop) return std::nullopt;
    if (!solution) continue;
    const std::optional<double> deviation = deviation_of_scale(*solution, optimizer, stop);
    if (stop) return std::nullopt;
    if (!deviation) continue;
    found.push_back({std::log(solution->factors.scale), 1.0 / (*deviation * *deviation), solution->factors.gravity});
    information += found.back().weight;
    logarithm += found.back().weight * found.back().logarithm;
  }
  if (found.empty()) return std::nullopt;
  logarithm /= information;
  double chi_square = 0.0;
  for (const Estimate& each : found) chi_square += each.weight * std::pow(each.logarithm - logarithm, 2);
  const Estimate& best = *std::max_element(found.begin(), found.end(),
                                           [](const Estimate& a, const Estimate& b) { return a.weight < b.weight; });
  constexpr double largest_gain = 2.0;  // of several chains over the best one
  const double combined = std::sqrt(1.0 / std::min(information, largest_gain * largest_gain * best.weight));
  const double disagreement = std::max(1.0, chi_square / std::max(1.0, static_cast<double>(found.size()) - 1.0));
  return ScaleEstimate{std::exp(logarithm), combined * std::sqrt(disagreement), best.gravity};
}

std::optional<MapInertia> estimate_metres(const RunPath& path, const UnplacedFrames& unplaced,
                                          const InertialHistory& inertia, const std::optional<MapInertia>& tracked,
                                          Optimizer& optimizer, const std::atomic<bool>& stop) {
  std::optional<MapInertia> result = tracked ? tracked : start_by_trajectory(path.trajectory, inertia);
  if (!result) return std::nullopt;
  const std::optional<ScaleEstimate> estimate = estimate_scale(path, unplaced, inertia, *result, optimizer, stop);
  if (!estimate || estimate->deviation > largest_scale_deviation) return std::nullopt;
  result->scale = estimate->scale;
  result->gravity = estimate->gravity;
  return result;
}

}  // namespace holdfast
