// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/metric_scale.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "frame_chains.hpp"
#include "holdfast/geometry/inertial_start.hpp"

namespace holdfast {

namespace {

constexpr double window_spacing = 0.2, least_window_time = 5.0;  // [s]
constexpr std::size_t most_window_poses = 100, most_windows = 4;
constexpr double mounting_prior = 0.015, time_offset_prior = 0.005;  // [rad], [s]
constexpr double largest_window_deviation = 0.1;                     // of the scale of the start, relative
constexpr double largest_scale_deviation = 0.01;                     // of the scale, relative

/// Poses that measurements link, and the motions between them.
struct MotionWindow {
  std::vector<Eigen::Isometry3d> T_world_camera;
  std::vector<geometry::Preintegration> motions;
  double time = 0.0;  // [s]
};

/// The trajectory at intervals, in a few windows of at most `most_window_poses` poses.
std::vector<MotionWindow> find_motion_windows(const Trajectory& trajectory, const InertialHistory& inertia) {
  std::vector<double> stamps;
  std::vector<Eigen::Isometry3d> poses;
  for (const TimedPose& pose : trajectory) {
    if (!stamps.empty() && pose.timestamp - stamps.back() < window_spacing) continue;
    stamps.push_back(pose.timestamp);
    poses.push_back(pose.T_world_camera);
  }
  std::vector<MotionWindow> windows;
  std::size_t last = std::numeric_limits<std::size_t>::max();
  for (const InertialHistory::Link& link : inertia.links(stamps, inertia.nominal())) {
    if (link.first != last || windows.back().T_world_camera.size() == most_window_poses)
      windows.push_back({{poses[link.first]}, {}, 0.0});
    windows.back().T_world_camera.push_back(poses[link.second]);
    windows.back().motions.push_back(link.measured);
    windows.back().time += link.measured.duration();
    last = link.second;
  }
  std::erase_if(windows, [](const MotionWindow& window) { return window.time < least_window_time; });
  if (windows.size() <= most_windows) return windows;
  std::vector<MotionWindow> chosen;  // evenly
  for (std::size_t i = 0; i < most_windows; ++i)
    chosen.push_back(std::move(windows[i * windows.size() / most_windows]));
  return chosen;
}

/// Angular velocity at each pose: the mean over the motions before and after it.
std::vector<Eigen::Vector3d> turn_rates_of(const MotionWindow& window) {
  std::vector<Eigen::Vector3d> of_motions, rates;
  for (const geometry::Preintegration& motion : window.motions)
    of_motions.push_back(geometry::log_so3(motion.delta().rotation) / motion.duration());
  for (std::size_t i = 0; i < window.T_world_camera.size(); ++i)
    rates.push_back(0.5 * (of_motions[i > 0 ? i - 1 : 0] + of_motions[std::min(i, of_motions.size() - 1)]));
  return rates;
}

/// The start with the first deviations of the poses that explain their residuals, or else with the largest.
geometry::InertialStart start_in_window(const MotionWindow& window, const MapInertia& nominal,
                                        geometry::InertialStartOptions& options) {
  const std::vector<Eigen::Vector3d> rates = turn_rates_of(window);
  options.estimate_scale = true;
  options.mounting_deviation = mounting_prior;
  options.time_offset_deviation = time_offset_prior;
  geometry::InertialStart start;
  for (const double deviation : {0.001, 0.002, 0.005, 0.01}) {
    options.position_deviation = deviation, options.rotation_deviation = 0.5 * deviation;
    start = geometry::start_inertially(window.T_world_camera, window.motions, nominal.T_body_camera, options, rates);
    if (start.mean_chi_square <= options.largest_mean_chi_square) break;
  }
  return start;
}

/// Estimates of the window that determines the scale best.
std::optional<MapInertia> start_by_trajectory(const Trajectory& trajectory, const InertialHistory& inertia) {
  std::optional<MapInertia> best;
  double best_deviation = largest_window_deviation;
  const MapInertia nominal = inertia.nominal();
  for (const MotionWindow& window : find_motion_windows(trajectory, inertia)) {
    geometry::InertialStartOptions options;
    const geometry::InertialStart start = start_in_window(window, nominal, options);
    if (!std::isfinite(start.mean_chi_square) || !(start.scale_deviation < best_deviation)) continue;
    best_deviation = start.scale_deviation;
    best = nominal;
    best->gravity = start.gravity;
    best->scale = start.scale;
    best->bias = start.bias;
    best->mounting = start.mounting;
    best->time_offset = start.time_offset;
    best->gravity_deviation = start.direction_deviation;
    best->gyroscope_deviation = start.gyroscope_bias_deviation;
    best->accelerometer_deviation = start.accelerometer_bias_deviation;
    best->mounting_deviation = mounting_prior;
    best->time_offset_deviation = time_offset_prior;
    best->position_deviation = options.position_deviation;
    best->rotation_deviation = options.rotation_deviation;
  }
  return best;
}

/// Relative standard deviation of the scale of a solution: by the increase of the cost where another scale is fixed,
/// times the root of the mean squared residual if that is larger than 1. Empty if a problem has no solution.
std::optional<double> deviation_of_scale(const FrameChains::Solution& solution, Optimizer& optimizer,
                                         const std::atomic<bool>& stop) {
  constexpr double step = 0.01;
  bool is_usable = true;
  const auto cost_at = [&](double factor) {
    BundleProblem problem = solution.problem;
    problem.factors.scale *= factor, problem.factors.scale_fixed = true;
    const BundleSummary summary = optimizer.optimize_bundle(problem, stop);
    is_usable = is_usable && summary.usable && !stop;
    return summary.final_cost;
  };
  const double larger = cost_at(std::exp(step)), smaller = cost_at(std::exp(-step));
  const double increase = 0.5 * (larger + smaller) - solution.cost;
  if (!is_usable || !(increase > 0.0)) return std::nullopt;
  const BundleFactors& factors = solution.problem.factors;
  const double residuals = 6.0 * static_cast<double>(factors.pose_priors.size() + factors.motion_priors.size()) +
                           15.0 * static_cast<double>(factors.inertial.size());
  constexpr double direction_and_scale = 3.0;
  const double unknowns = 6.0 * static_cast<double>(solution.problem.poses.size()) +
                          9.0 * static_cast<double>(factors.motions.size()) + direction_and_scale;
  const double mean_chi_square = 2.0 * solution.cost / std::max(1.0, residuals - unknowns);
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
    const std::optional<FrameChains::Solution> solution = frames.solve(chain, optimizer, stop);
    if (stop) return std::nullopt;
    if (!solution) continue;
    const std::optional<double> deviation = deviation_of_scale(*solution, optimizer, stop);
    if (stop) return std::nullopt;
    if (!deviation) continue;
    found.push_back({std::log(solution->problem.factors.scale), 1.0 / (*deviation * *deviation),
                     solution->problem.factors.gravity});
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
