// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/inertial_smoothing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "holdfast/core/median.hpp"
#include "holdfast/geometry/se3.hpp"

namespace holdfast {

namespace {

using Deviations = Eigen::Array2d;  // of a pose: position, rotation [rad]

/// Of tracked frames, before they are estimated: [m], [rad].
const Deviations first_deviations(0.003, 0.002);
constexpr double least_share = 0.03;           // of these: smaller ones are those of data without noise
constexpr double keyframe_share = 0.33;        // of the first ones: keyframes, which the adjustment placed
constexpr double keyframe_median_share = 0.5;  // of the median of those of frames
/// Deviations of the measurements by those of their noise: a mounting that is a degree wrong, scale factors or a time
/// offset are no white noise, and act for a second or more.
constexpr double model_factor = 3.0;
constexpr std::size_t most_frames = 900, fewest_frames = 3;  // of a chain
/// Frames on both sides of such a chain that are solved with it and not adopted, so that chains meet without a step.
constexpr std::size_t overlap = 60;
/// How far from tracked frames on one side alone frames without a pose get one [s].
constexpr double longest_prediction = 0.5;

enum class Role : std::uint8_t { tracked, drifting, missing, keyframe };

/// Frames `begin` to `end` - 1 of a trajectory that inertial measurements link, tracked ones at both ends. Those from
/// `first` to `last` - 1 are adopted.
struct Chain {
  std::size_t begin = 0, end = 0, first = 0, last = 0;
  std::vector<InertialHistory::Link> links;  // between successive indices, from `begin` on
};

Deviations upper_medians(const std::vector<Deviations>& values) {
  Deviations medians;
  std::vector<double> column;
  for (Eigen::Index k = 0; k < 2; ++k) {
    column.clear();
    for (const Deviations& value : values) column.push_back(value[k]);
    medians[k] = upper_median(column);
  }
  return medians;
}

class InertialSmoother {
 public:
  /// `deviation_factor`: of the deviations of the measurements. `scale_is_free`: the scale is a further unknown.
  InertialSmoother(const RunPath& path, const UnplacedFrames& unplaced, const InertialHistory& inertia,
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
    if (!keyframes_.empty()) add_missing(unplaced, tracked);
    for (const TimedPose& pose : trajectory_) {
      const Role placed = keyframes_.contains(pose.timestamp) ? Role::keyframe : Role::tracked;
      const bool is_missing = contains(unplaced.missing, pose.timestamp);
      roles_.push_back(is_missing ? Role::missing : drifts(pose) ? Role::drifting : placed);
    }
    smoothed_.resize(trajectory_.size());
  }

  /// The chains of the trajectory. Long ones are cut beside tracked frames, so that the cost is linear.
  std::vector<Chain> find_chains() const {
    std::vector<Chain> chains;
    for (std::size_t begin = 0, end = 0; begin < trajectory_.size(); begin = end) {
      end = std::min(begin + most_frames, trajectory_.size());
      const std::size_t latest = end;
      while (end < trajectory_.size() && end > begin && (drifts(end - 1) || drifts(end))) --end;
      if (end == begin) end = latest;
      add_chains(begin, end, chains);
    }
    return chains;
  }

  /// Solves a chain with the first deviations, and again with those that the solution leaves.
  std::optional<BundleProblem> solve(const Chain& chain, Optimizer& optimizer, const std::atomic<bool>& stop) const {
    BundleProblem problem = problem_of(chain);
    if (!optimizer.optimize_bundle(problem, stop).usable || stop) return std::nullopt;
    reweight(chain, problem);
    if (!optimizer.optimize_bundle(problem, stop).usable || stop) return std::nullopt;
    return problem;
  }

  /// Adopts the poses of a solution.
  void take(const Chain& chain, const BundleProblem& solution, Map& map) {
    move_keyframes(chain, solution, map);
    for (std::size_t i = chain.first; i < chain.last; ++i)
      if (roles_[i] != Role::keyframe) smoothed_[i] = solution.poses[i - chain.begin].T_camera_world;
  }

  /// Writes all frames, if any was smoothed: where a keyframe has moved, those that are relative to it and were not
  /// smoothed stay.
  InertialSmoothing write(FrameHistory& history, const Map& map) const {
    InertialSmoothing result;
    for (const std::optional<Eigen::Isometry3d>& pose : smoothed_) result.smoothed += pose ? 1 : 0;
    if (result.smoothed == 0) return result;
    for (std::size_t i = 0; i < trajectory_.size(); ++i) {
      const auto& [timestamp, T_world_camera] = trajectory_[i];
      if (roles_[i] != Role::missing) {
        if (!keyframes_.contains(timestamp))
          history.replace(timestamp, smoothed_[i].value_or(T_world_camera.inverse()), map);
      } else if (smoothed_[i]) {
        Frame frame;
        frame.timestamp = timestamp;
        frame.T_camera_world = *smoothed_[i];
        history.add_past(frame, keyframe_near(timestamp), map);
        ++result.placed;
      }
    }
    return result;
  }

 private:
  /// Adds the missing frames that are to be placed to the trajectory, with the pose of the nearest frame.
  void add_missing(const UnplacedFrames& unplaced, const Trajectory& tracked) {
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
  KeyFrameId keyframe_near(double timestamp) const {
    const auto after = keyframes_.lower_bound(timestamp);
    if (after == keyframes_.begin()) return after->second;
    const auto before = std::prev(after);
    return after != keyframes_.end() && after->first - timestamp < timestamp - before->first ? after->second
                                                                                             : before->second;
  }

  bool drifts(std::size_t i) const { return roles_[i] == Role::drifting || roles_[i] == Role::missing; }
  /// Whether a frame without a pose can have one by those before or after a tracked frame alone, which are tracked for
  /// `span`.
  bool is_predictable(std::size_t i, double tracked, double span) const {
    constexpr double rounding = 1e-6;
    return roles_[i] == Role::missing &&
           std::abs(trajectory_[i].timestamp - tracked) <= std::min(longest_prediction_, span) + rounding;
  }
  /// Of a prior, relative to measurements whose deviations are those of their noise.
  geometry::Matrix6d information_of(const Deviations& deviations) const {
    const Deviations values = (deviation_factor_ / deviations).square();
    geometry::Vector6d information;
    information.head<3>().setConstant(values[0]);
    information.tail<3>().setConstant(values[1]);
    return information.asDiagonal();
  }
  /// In the unit of the map.
  Deviations first_deviations_of_map() const { return {first_deviations[0] / estimates_.scale, first_deviations[1]}; }

  /// Adds the chains of the frames `first` to `last` - 1, with their overlap.
  void add_chains(std::size_t first, std::size_t last, std::vector<Chain>& chains) const {
    const std::size_t begin = first - std::min(first, overlap), end = std::min(last + overlap, trajectory_.size());
    std::vector<double> timestamps;
    for (std::size_t i = begin; i < end; ++i) timestamps.push_back(trajectory_[i].timestamp);
    std::vector<InertialHistory::Link> links = inertia_.links(timestamps, estimates_);
    for (std::size_t from = 0, to = 0; from < links.size(); from = to) {
      for (to = from + 1; to < links.size() && links[to].first == links[to - 1].second;) ++to;
      Chain chain{begin + links[from].first, begin + links[to - 1].second + 1, 0, 0, {}};
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

  BundleProblem problem_of(const Chain& chain) const {
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
  void turn_missing(const Chain& chain, BundleProblem& problem) const {
    const Eigen::Matrix3d R_body_camera = estimates_.mounting.transpose() * estimates_.T_body_camera.linear();
    const auto turn = [&](std::size_t from, std::size_t to, const Eigen::Matrix3d& R_from_to) {
      if (roles_[chain.begin + to] != Role::missing) return;
      const Eigen::Isometry3d T_world_camera = problem.poses[to].T_camera_world.inverse();
      const Eigen::Matrix3d R_camera_world = R_body_camera.transpose() * R_from_to.transpose() * R_body_camera *
                                             problem.poses[from].T_camera_world.linear();
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
  void reweight(const Chain& chain, BundleProblem& problem) const {
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
  Value mean_around(const Chain& chain, std::size_t pose, const std::vector<Value>& values, bool drifting_count) const {
    constexpr std::size_t reach = 7;
    Value sum = Value::Zero();
    double count = 0.0;
    for (std::size_t k = pose < reach ? 0 : pose - reach; k < std::min(values.size(), pose + reach + 1); ++k) {
      if (roles_[chain.begin + k] == Role::tracked || (drifting_count && drifts(chain.begin + k)))
        sum += values[k], count += 1.0;
    }
    return sum / count;
  }

  /// Moves drifting keyframes, with the points that they alone observe.
  void move_keyframes(const Chain& chain, const BundleProblem& solution, Map& map) {
    std::map<KeyFrameId, Eigen::Isometry3d> motions;  // T_world_world, from old to new
    for (std::size_t i = chain.first; i < chain.last; ++i) {
      const auto found = keyframes_.find(trajectory_[i].timestamp);
      if (!drifts(i) || found == keyframes_.end()) continue;
      Eigen::Isometry3d& pose = map.keyframe(found->second).frame.T_camera_world;
      const Eigen::Isometry3d& moved = solution.poses[i - chain.begin].T_camera_world;
      motions[found->second] = moved.inverse() * pose;
      pose = moved;
    }
    if (motions.empty()) return;
    for (const MapPointId id : map.points().ids()) {
      MapPoint& point = map.point(id);
      const auto motion = motions.find(point.reference_keyframe);
      const auto moves = [&](const Observation& seen) { return motions.contains(seen.keyframe); };
      if (motion == motions.end() || !std::all_of(point.observations.begin(), point.observations.end(), moves))
        continue;
      point.position = motion->second * point.position;
      point.viewing_direction = motion->second.linear() * point.viewing_direction;
    }
    map.invalidate_copies();
  }

  const InertialHistory& inertia_;
  const MapInertia estimates_;
  const double deviation_factor_;
  const bool scale_is_free_;
  const std::shared_ptr<const Camera> camera_;
  const std::map<double, KeyFrameId> keyframes_;            // by time stamp
  const double longest_prediction_;                         // [s]
  Trajectory trajectory_;                                   // before, with missing frames that are to be placed
  std::vector<std::optional<Eigen::Isometry3d>> smoothed_;  // T_camera_world, as far as chains were solved
  std::vector<Role> roles_;                                 // by frame of the trajectory
};

/// Relative standard deviation of the scale of a solution: by the increase of the cost where another scale is fixed,
/// times the root of the mean squared residual if that is larger than 1. Empty if a problem has no solution.
std::optional<double> deviation_of_scale(const BundleProblem& solution, Optimizer& optimizer,
                                         const std::atomic<bool>& stop) {
  constexpr double step = 0.01;
  bool is_usable = true;
  const auto cost_at = [&](double scale) {
    BundleProblem problem = solution;
    problem.factors.scale = scale, problem.factors.scale_fixed = true;
    const BundleSummary summary = optimizer.optimize_bundle(problem, stop);
    is_usable = is_usable && summary.usable && !stop;
    return summary.final_cost;
  };
  const double cost = cost_at(solution.factors.scale);
  const double larger = cost_at(solution.factors.scale * std::exp(step));
  const double smaller = cost_at(solution.factors.scale * std::exp(-step));
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

void follow_keyframes(FrameHistory& history, const Map& map, const Trajectory& before) {
  const Trajectory after = history.trajectory(map);
  if (after.size() != before.size()) return;
  const auto moved = [&](std::size_t keyframe, std::size_t i) {
    return after[keyframe].T_world_camera * before[keyframe].T_world_camera.inverse() * before[i].T_world_camera;
  };
  constexpr double longest = 2.0;  // s
  std::optional<std::size_t> first;
  for (std::size_t second = 0; second < after.size(); ++second) {
    const auto pose = history.past_pose(after[second].timestamp, map);
    if (!pose || !pose->is_keyframe) continue;
    if (first && after[second].timestamp - after[*first].timestamp > longest) first.reset();
    for (std::size_t i = first.value_or(second) + 1; i < second; ++i) {
      const double share =
          (after[i].timestamp - after[*first].timestamp) / (after[second].timestamp - after[*first].timestamp);
      const Eigen::Isometry3d a = moved(*first, i), b = moved(second, i);
      const Eigen::Quaterniond rotation = Eigen::Quaterniond(a.linear()).slerp(share, Eigen::Quaterniond(b.linear()));
      Eigen::Isometry3d T_world_camera(rotation);
      T_world_camera.translation() = (1.0 - share) * a.translation() + share * b.translation();
      history.replace(after[i].timestamp, T_world_camera.inverse(), map);
    }
    first = second;
  }
}

RunPath path_of(const FrameHistory& history, const Map& map, const InertialHistory& inertia) {
  RunPath path;
  if (map.keyframes().size() == 0 || history.main_submap(map) != inertia.submap()) return path;
  path.trajectory = history.trajectory(map);
  const std::vector<KeyFrameId> keyframes = map.keyframes_by_age();
  const std::vector<double> stamps = linkable_stamps(map, keyframes, inertia);
  for (std::size_t i = 0; i < keyframes.size(); ++i)
    if (!std::isnan(stamps[i])) path.keyframes[stamps[i]] = keyframes[i];
  path.camera = map.keyframe(keyframes.front()).frame.camera;
  return path;
}

std::optional<ScaleEstimate> estimate_scale(const RunPath& path, const UnplacedFrames& unplaced,
                                            const InertialHistory& inertia, const MapInertia& estimates,
                                            Optimizer& optimizer, const std::atomic<bool>& stop) {
  if (!path.camera) return std::nullopt;
  const InertialSmoother smoother(path, unplaced, inertia, estimates, 1.0, true);
  struct Estimate {
    double logarithm, weight;
    Eigen::Vector3d gravity;
  };
  std::vector<Estimate> found;
  double information = 0.0, logarithm = 0.0;
  for (const Chain& chain : smoother.find_chains()) {
    const std::optional<BundleProblem> solution = smoother.solve(chain, optimizer, stop);
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

InertialSmoothing smooth_by_inertia(FrameHistory& history, Map& map, const UnplacedFrames& unplaced,
                                    const InertialHistory& inertia, Optimizer& optimizer,
                                    const std::atomic<bool>& stop) {
  const std::optional<MapInertia> estimates = inertia.estimates();
  const RunPath path = path_of(history, map, inertia);
  if (!estimates || !path.camera) return {};
  InertialSmoother smoother(path, unplaced, inertia, *estimates, model_factor, false);
  for (const Chain& chain : smoother.find_chains()) {
    const std::optional<BundleProblem> solution = smoother.solve(chain, optimizer, stop);
    if (stop) break;
    if (solution) smoother.take(chain, *solution, map);
  }
  return smoother.write(history, map);
}

}  // namespace holdfast
