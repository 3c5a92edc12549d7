// SPDX-License-Identifier: BSD-3-Clause
#include "frame_chains.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "holdfast/core/median.hpp"
#include "holdfast/geometry/se3.hpp"

namespace holdfast {

namespace {

/// Of tracked frames, before they are estimated: [m], [rad].
const Eigen::Array2d first_deviations(0.003, 0.002);
constexpr double least_share = 0.03;           // of these: smaller ones are those of data without noise
constexpr double keyframe_share = 0.33;        // of the first ones: keyframes, which the adjustment placed
constexpr double keyframe_median_share = 0.5;  // of the median of those of frames
constexpr std::size_t most_frames = 900, fewest_frames = 3;  // of a chain
/// Frames on both sides of such a chain that are solved with it and not adopted, so that chains meet without a step.
constexpr std::size_t overlap = 60;
/// How far from tracked frames on one side alone frames without a pose get one [s].
constexpr double longest_prediction = 0.5;

Eigen::Array2d upper_medians(const std::vector<Eigen::Array2d>& values) {
  Eigen::Array2d medians;
  std::vector<double> column;
  for (Eigen::Index k = 0; k < 2; ++k) {
    column.clear();
    for (const Eigen::Array2d& value : values) column.push_back(value[k]);
    medians[k] = upper_median(column);
  }
  return medians;
}

}  // namespace

FrameChains::FrameChains(const RunPath& path, const UnplacedFrames& unplaced, const InertialHistory& inertia,
                         const MapInertia& estimates, double deviation_factor, bool scale_is_free)
    : inertia_(inertia),
      estimates_(estimates),
      deviation_factor_(deviation_factor),
      scale_is_free_(scale_is_free),
      camera_(path.camera),
      keyframes_(path.keyframes),
      longest_prediction_(std::min(longest_prediction, unplaced.longest_gap)) {
  const auto contains = [](const std::vector<double>& sorted, double stamp) {
    return std::binary_search(sorted.begin(), sorted.end(), stamp);
  };
  const auto drifts = [&](const TimedPose& pose) {
    return contains(unplaced.frames, pose.timestamp) || contains(unplaced.keyframes, pose.timestamp);
  };
  Trajectory tracked = path.trajectory;
  std::erase_if(tracked, drifts);
  trajectory_ = path.trajectory;
  add_missing(unplaced, tracked);
  for (const TimedPose& pose : trajectory_) {
    const Role placed = keyframes_.contains(pose.timestamp) ? Role::keyframe : Role::tracked;
    const bool is_missing = contains(unplaced.missing, pose.timestamp);
    roles_.push_back(is_missing ? Role::missing : drifts(pose) ? Role::drifting : placed);
  }
}

std::vector<FrameChain> FrameChains::find() const {
  std::vector<FrameChain> chains;
  for (std::size_t begin = 0, end = 0; begin < trajectory_.size(); begin = end) {
    end = std::min(begin + most_frames, trajectory_.size());
    const std::size_t latest = end;
    while (end < trajectory_.size() && end > begin && (drifts(end - 1) || drifts(end))) --end;
    if (end == begin) end = latest;
    add_chains(begin, end, chains);
  }
  return chains;
}

std::optional<BundleProblem> FrameChains::solve(const FrameChain& chain, Optimizer& optimizer,
                                                const std::atomic<bool>& stop) const {
  BundleProblem problem = problem_of(chain);
  if (!optimizer.optimize_bundle(problem, stop).usable || stop) return std::nullopt;
  reweight(chain, problem);
  if (!optimizer.optimize_bundle(problem, stop).usable || stop) return std::nullopt;
  return problem;
}

/// Adds the missing frames that are to be placed to the trajectory, with the pose of the nearest frame.
void FrameChains::add_missing(const UnplacedFrames& unplaced, const Trajectory& tracked) {
  const auto next = [](const Trajectory& poses, double time) {
    return std::upper_bound(poses.begin(), poses.end(), time,
                            [](double at, const TimedPose& pose) { return at < pose.timestamp; });
  };
  constexpr double never = std::numeric_limits<double>::infinity();
  Trajectory added;
  for (const double timestamp : unplaced.missing) {
    if (keyframes_.contains(timestamp)) continue;
    const auto after = next(tracked, timestamp);
    const double since = after != tracked.begin() ? timestamp - std::prev(after)->timestamp : never;
    const double until = after != tracked.end() ? after->timestamp - timestamp : never;
    if (since + until > unplaced.longest_gap && std::min(since, until) > longest_prediction_) continue;
    added.push_back({timestamp, since < until ? std::prev(after)->T_world_camera : after->T_world_camera});
  }
  trajectory_.insert(trajectory_.end(), added.begin(), added.end());
  std::sort(trajectory_.begin(), trajectory_.end(),
            [](const TimedPose& first, const TimedPose& second) { return first.timestamp < second.timestamp; });
}

/// Whether a frame without a pose can have one by those before or after a tracked frame alone, which are tracked for
/// `span`.
bool FrameChains::is_predictable(std::size_t i, double tracked, double span) const {
  constexpr double rounding = 1e-6;
  return roles_[i] == Role::missing &&
         std::abs(trajectory_[i].timestamp - tracked) <= std::min(longest_prediction_, span) + rounding;
}

/// Of a prior, relative to measurements whose deviations are those of their noise.
geometry::Matrix6d FrameChains::information_of(const Deviations& deviations) const {
  const Deviations values = (deviation_factor_ / deviations).square();
  geometry::Vector6d information;
  information.head<3>().setConstant(values[0]);
  information.tail<3>().setConstant(values[1]);
  return information.asDiagonal();
}

/// In the unit of the map.
FrameChains::Deviations FrameChains::first_deviations_of_map() const {
  return {first_deviations[0] / estimates_.scale, first_deviations[1]};
}

/// Adds the chains of the frames `first` to `last` - 1, with their overlap.
void FrameChains::add_chains(std::size_t first, std::size_t last, std::vector<FrameChain>& chains) const {
  const std::size_t begin = first - std::min(first, overlap), end = std::min(last + overlap, trajectory_.size());
  std::vector<double> timestamps;
  for (std::size_t i = begin; i < end; ++i) timestamps.push_back(trajectory_[i].timestamp);
  std::vector<InertialHistory::Link> links = inertia_.links(timestamps, estimates_);
  for (std::size_t from = 0, to = 0; from < links.size(); from = to) {
    for (to = from + 1; to < links.size() && links[to].first == links[to - 1].second;) ++to;
    FrameChain chain{begin + links[from].first, begin + links[to - 1].second + 1, 0, 0, {}};
    const std::size_t lowest = chain.begin, highest = chain.end;
    while (chain.begin < chain.end && drifts(chain.begin)) ++chain.begin;
    while (chain.begin < chain.end && drifts(chain.end - 1)) --chain.end;
    if (chain.end - chain.begin < fewest_frames) continue;
    const double begins = trajectory_[chain.begin].timestamp, ends = trajectory_[chain.end - 1].timestamp;
    while (chain.begin > lowest && is_predictable(chain.begin - 1, begins, ends - begins)) --chain.begin;
    while (chain.end < highest && is_predictable(chain.end, ends, ends - begins)) ++chain.end;
    chain.first = std::max(first, chain.begin), chain.last = std::min(last, chain.end);
    if (chain.first >= chain.last) continue;
    for (std::size_t k = from; k < to; ++k) {
      InertialHistory::Link& link = links[k];
      if (begin + link.first < chain.begin || begin + link.second >= chain.end) continue;
      link.first = begin + link.first - chain.begin, link.second = begin + link.second - chain.begin;
      chain.links.push_back(std::move(link));
    }
    chains.push_back(std::move(chain));
  }
}

BundleProblem FrameChains::problem_of(const FrameChain& chain) const {
  BundleProblem problem;
  problem.camera = camera_.get();
  for (std::size_t i = chain.begin; i < chain.end; ++i) {
    const Eigen::Isometry3d T_camera_world = trajectory_[i].T_world_camera.inverse();
    const auto pose = static_cast<std::uint32_t>(problem.poses.size());
    problem.poses.push_back({T_camera_world, false});
    if (drifts(i)) continue;
    const double share = roles_[i] == Role::keyframe ? keyframe_share : 1.0;
    problem.factors.pose_priors.push_back({pose, T_camera_world, information_of(share * first_deviations_of_map())});
  }
  turn_missing(chain, problem);
  add_inertial_factors(problem, chain.links, estimates_);
  problem.factors.scale_fixed = !scale_is_free_;
  for (BundleFactors::MotionPrior& prior : problem.factors.motion_priors)
    prior.information *= deviation_factor_ * deviation_factor_;
  problem.robust_iterations = 0, problem.final_iterations = 50;  // no observation is an outlier
  problem.function_tolerance = 1e-6;
  return problem;
}

/// Turns frames without a pose as the gyroscope says: a solution begins there, and half a turn could end elsewhere.
void FrameChains::turn_missing(const FrameChain& chain, BundleProblem& problem) const {
  const Eigen::Matrix3d R_body_camera = estimates_.mounting.transpose() * estimates_.T_body_camera.linear();
  const auto turn = [&](std::size_t from, std::size_t to, const Eigen::Matrix3d& R_from_to) {
    if (roles_[chain.begin + to] != Role::missing) return;
    const Eigen::Isometry3d T_world_camera = problem.poses[to].T_camera_world.inverse();
    const Eigen::Matrix3d R_camera_world =
        R_body_camera.transpose() * R_from_to.transpose() * R_body_camera * problem.poses[from].T_camera_world.linear();
    problem.poses[to].T_camera_world.linear() = R_camera_world;
    problem.poses[to].T_camera_world.translation() = -R_camera_world * T_world_camera.translation();
  };
  const auto has_pose = [](Role role) { return role != Role::missing; };
  const auto first = std::find_if(roles_.begin() + static_cast<std::ptrdiff_t>(chain.begin), roles_.end(), has_pose);
  const auto leading = static_cast<std::size_t>(first - roles_.begin()) - chain.begin;
  for (std::size_t k = leading; k < chain.links.size(); ++k) turn(k, k + 1, chain.links[k].measured.delta().rotation);
  for (std::size_t k = leading; k-- > 0;) turn(k + 1, k, chain.links[k].measured.delta().rotation.transpose());
}

/// Deviations of tracked frames: the root mean square, within seven frames to each side, of what the solution changed
/// beside their mean, with Cauchy's robust factor for outliers. The mean does not count: errors of tracking grow for
/// some frames, but a slow change may be one of the measurements as well, which must not take the weight of poses.
/// Drifting frames count as unchanged, so that a few frames between them cannot be their own mean.
void FrameChains::reweight(const FrameChain& chain, BundleProblem& problem) const {
  std::vector<geometry::Vector6d> moved(problem.poses.size(), geometry::Vector6d::Zero());
  for (const BundleFactors::PosePrior& prior : problem.factors.pose_priors)
    moved[prior.pose] = geometry::log_se3(problem.poses[prior.pose].T_camera_world * prior.T_camera_world.inverse());
  std::vector<Deviations> changes(moved.size(), Deviations::Zero()), of_frames;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    if (roles_[chain.begin + i] != Role::tracked) continue;
    const geometry::Vector6d change = moved[i] - mean_around(chain, i, moved, true);
    changes[i] = Deviations(change.head<3>().norm(), change.tail<3>().norm()) / std::sqrt(3.0);
    of_frames.push_back(changes[i]);
  }
  if (of_frames.empty()) return;
  std::vector<Deviations> squares;
  for (const Deviations& change : changes) squares.push_back(change.square());
  const Deviations median = upper_medians(of_frames);
  const Deviations least = least_share * first_deviations_of_map();
  for (BundleFactors::PosePrior& prior : problem.factors.pose_priors) {
    Deviations deviations = keyframe_median_share * median;
    if (roles_[chain.begin + prior.pose] == Role::tracked) {
      deviations = mean_around(chain, prior.pose, squares, false).sqrt();
      deviations = deviations.max(0.3 * median).max(least);
      deviations *= (1.0 + (changes[prior.pose] / (2.0 * deviations)).square()).sqrt();
    }
    prior.information = information_of(deviations.max(least));
  }
}

/// Of the tracked frames within seven frames to each side, and of the drifting ones if these count.
template <class Value>
Value FrameChains::mean_around(const FrameChain& chain, std::size_t pose, const std::vector<Value>& values,
                               bool drifting_count) const {
  constexpr std::size_t reach = 7;
  Value sum = Value::Zero();
  double count = 0.0;
  for (std::size_t k = pose < reach ? 0 : pose - reach; k < std::min(values.size(), pose + reach + 1); ++k) {
    if (roles_[chain.begin + k] == Role::tracked || (drifting_count && drifts(chain.begin + k)))
      sum += values[k], count += 1.0;
  }
  return sum / count;
}

}  // namespace holdfast
