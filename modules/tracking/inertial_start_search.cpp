// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/inertial_start_search.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace holdfast {

namespace {

constexpr double possible_deviations[] = {0.001, 0.002, 0.005, 0.01, 0.02};  // of positions [m]
constexpr double rotation_share = 0.5;                                       // [rad/m]
/// A change of the gyroscope's bias that turns the motion between two poses by more than this [rad] is integrated anew.
constexpr double largest_linear_turn = 0.02;
constexpr int most_integrations = 3;

/// Motions from each pose to the next; empty where samples are missing.
std::optional<std::vector<geometry::Preintegration>> preintegrate_between(const Trajectory& poses,
                                                                          std::span<const ImuSample> samples,
                                                                          const ImuNoise& noise, const ImuBias& bias) {
  std::vector<geometry::Preintegration> motions;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    const auto motion = geometry::preintegrate(samples, poses[i].timestamp, poses[i + 1].timestamp, noise, bias);
    if (!motion) return std::nullopt;
    motions.push_back(*motion);
  }
  return motions;
}

/// False for the biases of a solution that diverged.
bool is_possible(const ImuBias& bias) {
  constexpr double most_deviations = 10.0;
  const geometry::InertialStartOptions priors;
  return bias.gyroscope.norm() < most_deviations * priors.gyroscope_bias_deviation &&
         bias.accelerometer.norm() < most_deviations * priors.accelerometer_bias_deviation;
}

/// Whether the motions depend linearly on biases up to these.
bool is_linear(const std::vector<geometry::Preintegration>& motions, const ImuBias& bias) {
  return std::all_of(motions.begin(), motions.end(), [&](const geometry::Preintegration& motion) {
    return motion.duration() * (bias.gyroscope - motion.bias().gyroscope).norm() <= largest_linear_turn;
  });
}

}  // namespace

Eigen::Vector3d rate_at(std::span<const ImuSample> samples, double time) {
  const auto is_earlier = [](const ImuSample& sample, double at) { return sample.timestamp < at; };
  const auto next = std::lower_bound(samples.begin(), samples.end(), time, is_earlier);
  if (next == samples.begin()) return samples.front().angular_velocity;
  if (next == samples.end()) return samples.back().angular_velocity;
  return geometry::interpolated(*std::prev(next), *next, time).angular_velocity;
}

std::optional<FoundInertialStart> find_inertial_start(const Trajectory& poses, std::span<const ImuSample> samples,
                                                      const ImuCalibration& imu, const InertialStartSearch& search) {
  if (samples.empty()) return std::nullopt;
  const auto unbiased_motions = preintegrate_between(poses, samples, imu.noise, {});
  if (!unbiased_motions) return std::nullopt;
  FoundInertialStart found{.start = {}, .poses = poses, .motions = {}, .rates = {}, .deviations = {}};
  std::vector<Eigen::Isometry3d> T_world_camera;
  for (const TimedPose& pose : poses) {
    T_world_camera.push_back(pose.T_world_camera);
    found.rates.push_back(rate_at(samples, pose.timestamp));
  }
  geometry::InertialStartOptions options;
  options.estimate_scale = search.estimate_scale;
  options.largest_direction_deviation = search.largest_direction_deviation;
  options.largest_scale_deviation = search.largest_scale_deviation;
  options.largest_velocity_deviation = search.largest_velocity_deviation;
  options.mounting_deviation = nominal_mounting_deviation;
  options.time_offset_deviation = nominal_time_offset_deviation;
  const auto solve = [&](std::vector<geometry::Preintegration> motions) {
    found.motions = std::move(motions);
    found.start = geometry::start_inertially(T_world_camera, found.motions, imu.T_body_camera, options, found.rates);
  };
  for (const double deviation : possible_deviations) {
    if (deviation < search.smallest_deviation || deviation > search.largest_deviation) continue;
    options.position_deviation = deviation;
    options.rotation_deviation = rotation_share * deviation;
    solve(*unbiased_motions);
    const ImuBias& bias = found.start.bias;
    for (int i = 0; i < most_integrations && !is_linear(found.motions, bias) && is_possible(bias); ++i) {
      auto motions = preintegrate_between(poses, samples, imu.noise, bias);
      if (!motions) return std::nullopt;
      solve(*std::move(motions));
    }
    if (!found.start.usable) continue;
    // The mean squared residual, which is 1 for right deviations, says how wrong these are.
    const double factor = std::sqrt(std::max(1.0, found.start.mean_chi_square));
    found.deviations = {factor * options.position_deviation, factor * options.rotation_deviation};
    return found;
  }
  return std::nullopt;
}

}  // namespace holdfast
