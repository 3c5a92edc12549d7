// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/interfaces/inertial_history.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "holdfast/core/imu_timeline.hpp"

namespace holdfast {

namespace {

constexpr std::size_t max_samples = 240000;
constexpr double max_link = 5.0;  // [s]
/// Smallest standard deviations of the biases where a chain begins [rad/s], [m/s^2]: those of tracking are too small,
/// because its errors are correlated.
constexpr double min_gyroscope_deviation = 0.003, min_accelerometer_deviation = 0.03;

bool is_earlier(const ImuSample& sample, double time) { return sample.timestamp < time; }

/// Whether a covariance has full rank beyond rounding, judged by the correlations.
bool has_full_rank(const geometry::Matrix15d& covariance) {
  constexpr double min_share = 1e-6;  // of a variance that the numbers before it do not explain
  if (!covariance.allFinite() || !(covariance.diagonal().minCoeff() > 0.0)) return false;
  const geometry::Vector15d scales = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<geometry::Matrix15d> cholesky(scales.asDiagonal() * covariance * scales.asDiagonal());
  return cholesky.info() == Eigen::Success && cholesky.matrixLLT().diagonal().cwiseAbs2().minCoeff() > min_share;
}

/// State of the body at a pose, in metres.
Eigen::Isometry3d body_pose(const BundleProblem& problem, std::uint32_t pose) {
  Eigen::Isometry3d T_world_camera = problem.poses[pose].T_camera_world.inverse();
  T_world_camera.translation() *= problem.factors.scale;
  return T_world_camera * problem.factors.T_body_camera.inverse();
}

/// Velocities at both ends of a motion that connect two poses.
std::array<Eigen::Vector3d, 2> velocities(const Eigen::Isometry3d& first, const Eigen::Isometry3d& second,
                                          const geometry::Preintegration& measured, const Eigen::Vector3d& gravity) {
  const double time = measured.duration();
  const geometry::InertialDelta& delta = measured.delta();
  const Eigen::Vector3d begin =
      (second.translation() - first.translation() - first.linear() * delta.position) / time - 0.5 * time * gravity;
  return {begin, begin + time * gravity + first.linear() * delta.velocity};
}

BundleFactors::MotionPrior bias_prior(std::uint32_t motion, const MapInertia& estimates) {
  BundleFactors::MotionPrior prior{.motion = motion, .bias = estimates.bias, .information = {}};
  const double gyroscope_deviation = std::max(estimates.gyroscope_deviation, min_gyroscope_deviation);
  const double accelerometer_deviation = std::max(estimates.accelerometer_deviation, min_accelerometer_deviation);
  Eigen::Matrix<double, 9, 1> information = Eigen::Matrix<double, 9, 1>::Zero();
  information.segment<3>(3).setConstant(1.0 / (gyroscope_deviation * gyroscope_deviation));
  information.tail<3>().setConstant(1.0 / (accelerometer_deviation * accelerometer_deviation));
  prior.information = information.asDiagonal();
  return prior;
}

}  // namespace

bool is_calibrated_as(const MapInertia& estimates, const ImuCalibration& imu) {
  constexpr double tolerance = 1e-6;
  return (estimates.T_body_camera.matrix() - imu.T_body_camera.matrix()).cwiseAbs().maxCoeff() < tolerance &&
         std::abs(estimates.calibrated_time_offset - imu.time_offset) < tolerance;
}

void InertialHistory::add(const SensorFrame& frame) {
  const std::lock_guard lock(mutex_);
  append_imu(samples_, frame.imu);
  if (samples_.size() <= max_samples) return;
  samples_.erase(samples_.begin(), samples_.end() - static_cast<std::ptrdiff_t>(max_samples * 9 / 10));
}

void InertialHistory::set_estimates(const std::optional<MapInertia>& estimates, std::uint32_t submap) {
  const std::lock_guard lock(mutex_);
  submap_ = submap;
  if (estimates && is_calibrated_as(*estimates, imu_)) estimates_[submap] = *estimates;
}

void InertialHistory::set_gravity(const Eigen::Vector3d& gravity, std::uint32_t submap) {
  const std::lock_guard lock(mutex_);
  const auto found = estimates_.find(submap);
  if (found != estimates_.end()) found->second.gravity = gravity;
}

void InertialHistory::forget_map() {
  const std::lock_guard lock(mutex_);
  estimates_.clear();
  submap_ = 0;
  first_sequence_ = 0;
}

std::optional<MapInertia> InertialHistory::estimates() const {
  const std::lock_guard lock(mutex_);
  const auto found = estimates_.find(submap_);
  return found != estimates_.end() ? std::optional(found->second) : std::nullopt;
}

std::vector<ImuSample> InertialHistory::samples() const {
  const std::lock_guard lock(mutex_);
  return samples_;
}

MapInertia InertialHistory::nominal() const {
  MapInertia result;
  result.T_body_camera = imu_.T_body_camera;
  result.calibrated_time_offset = imu_.time_offset;
  return result;
}

std::uint64_t InertialHistory::first_sequence() const {
  const std::lock_guard lock(mutex_);
  return first_sequence_;
}

std::uint32_t InertialHistory::submap() const {
  const std::lock_guard lock(mutex_);
  return submap_;
}

/// A pose is measured `time_offset` after the state of the body (InertialFilter).
std::optional<geometry::Preintegration> InertialHistory::motion_between(std::span<const ImuSample> samples,
                                                                        double begin, double end,
                                                                        const MapInertia& estimates) const {
  begin += estimates.time_offset, end += estimates.time_offset;
  if (!(end - begin <= max_link)) return std::nullopt;
  auto first = std::lower_bound(samples.begin(), samples.end(), begin, is_earlier);
  if (first != samples.begin()) --first;
  auto last = std::lower_bound(first, samples.end(), end, is_earlier);
  if (last != samples.end()) ++last;
  if (has_saturated({first, last}, imu_)) return std::nullopt;
  const std::vector<ImuSample> covered = covering({first, last}, begin, end, imu_);
  std::optional<geometry::Preintegration> motion =
      geometry::preintegrate(covered, begin, end, imu_.noise, estimates.bias);
  if (motion && !has_full_rank(motion->covariance())) motion.reset();
  return motion;
}

std::vector<InertialHistory::Link> InertialHistory::links(std::span<const double> timestamps) const {
  const std::optional<MapInertia> estimates = this->estimates();
  return estimates ? links(timestamps, *estimates) : std::vector<Link>();
}

std::vector<InertialHistory::Link> InertialHistory::links(std::span<const double> timestamps,
                                                          const MapInertia& estimates) const {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < timestamps.size(); ++i)
    if (!std::isnan(timestamps[i])) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return timestamps[a] < timestamps[b]; });
  std::vector<Link> links;
  const std::vector<ImuSample> samples = this->samples();  // a copy, because tracking waits for the mutex
  for (std::size_t i = 0; i + 1 < order.size(); ++i)
    if (const auto motion = motion_between(samples, timestamps[order[i]], timestamps[order[i + 1]], estimates))
      links.push_back({order[i], order[i + 1], *motion});
  return links;
}

std::vector<double> linkable_stamps(const Map& map, std::span<const KeyFrameId> keyframes,
                                    const InertialHistory& history) {
  const std::uint32_t submap = history.submap();
  const std::uint64_t first_sequence = history.first_sequence();
  std::vector<double> timestamps;
  for (const KeyFrameId id : keyframes) {
    const KeyFrame& keyframe = map.keyframe(id);
    const bool is_linkable = keyframe.submap == submap && keyframe.sequence >= first_sequence;
    timestamps.push_back(is_linkable ? keyframe.frame.timestamp : std::numeric_limits<double>::quiet_NaN());
  }
  return timestamps;
}

std::vector<std::uint8_t> add_inertial_factors(BundleProblem& problem, std::span<const InertialHistory::Link> links,
                                               const MapInertia& estimates) {
  std::vector<std::uint8_t> is_linked(problem.poses.size(), 0);
  BundleFactors& factors = problem.factors;
  // A pose by the nominal calibration lacks the rotation of the mounting.
  factors.T_body_camera = Eigen::Isometry3d(estimates.mounting.transpose()) * estimates.T_body_camera;
  factors.gravity = estimates.gravity;
  factors.scale = estimates.scale;
  std::vector<std::uint32_t> motion_of(problem.poses.size(), FactorEvaluation::none);
  const auto motion = [&](std::size_t pose, const Eigen::Vector3d& velocity) {
    if (motion_of[pose] == FactorEvaluation::none) {
      motion_of[pose] = static_cast<std::uint32_t>(factors.motions.size());
      factors.motions.push_back({static_cast<std::uint32_t>(pose), velocity, estimates.bias});
    }
    is_linked[pose] = 1;
    return motion_of[pose];
  };
  for (const InertialHistory::Link& link : links) {
    if (problem.poses[link.first].fixed && problem.poses[link.second].fixed) continue;
    const auto [begin, end] =
        velocities(body_pose(problem, static_cast<std::uint32_t>(link.first)),
                   body_pose(problem, static_cast<std::uint32_t>(link.second)), link.measured, factors.gravity);
    const bool begins_chain = motion_of[link.first] == FactorEvaluation::none;
    const std::uint32_t first = motion(link.first, begin), second = motion(link.second, end);
    factors.motions[first].velocity = begin;
    factors.inertial.push_back({first, second, link.measured});
    if (begins_chain) factors.motion_priors.push_back(bias_prior(first, estimates));
  }
  return is_linked;
}

}  // namespace holdfast
