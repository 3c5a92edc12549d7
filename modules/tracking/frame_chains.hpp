// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "holdfast/interfaces/inertial_history.hpp"
#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/tracking/inertial_smoothing.hpp"

namespace holdfast {

/// Frames `begin` to `end` - 1 of a trajectory that inertial measurements link, tracked ones at both ends. Those from
/// `first` to `last` - 1 are adopted.
struct FrameChain {
  std::size_t begin = 0, end = 0, first = 0, last = 0;
  std::vector<InertialHistory::Link> links;  ///< between successive indices, from `begin` on
};

/// The frames of a run as chains, and the problem of their poses that smooth_by_inertia() and estimate_scale() solve.
class FrameChains {
 public:
  enum class Role : std::uint8_t { tracked, drifting, missing, keyframe };

  /// `deviation_factor`: of the deviations of the measurements. `scale_is_free`: the scale is a further unknown.
  FrameChains(const RunPath& path, const UnplacedFrames& unplaced, const InertialHistory& inertia,
              const MapInertia& estimates, double deviation_factor, bool scale_is_free);

  /// The trajectory before, with missing frames that are to be placed.
  const Trajectory& trajectory() const { return trajectory_; }
  Role role(std::size_t frame) const { return roles_[frame]; }
  /// Whether no view placed a frame, with or without a pose.
  bool drifts(std::size_t i) const { return roles_[i] == Role::drifting || roles_[i] == Role::missing; }

  /// The chains of the trajectory. Long ones are cut beside tracked frames, so that the cost is linear.
  std::vector<FrameChain> find() const;
  /// Solves a chain with the first deviations, and again with those that the solution leaves; the pose of its first
  /// frame comes first. Empty if a problem has no solution, or when stopped.
  std::optional<BundleProblem> solve(const FrameChain& chain, Optimizer& optimizer,
                                     const std::atomic<bool>& stop) const;

 private:
  using Deviations = Eigen::Array2d;  // of a pose: position, rotation [rad]

  void add_missing(const UnplacedFrames& unplaced, const Trajectory& tracked);
  bool is_predictable(std::size_t i, double tracked, double span) const;
  geometry::Matrix6d information_of(const Deviations& deviations) const;
  Deviations first_deviations_of_map() const;
  void add_chains(std::size_t first, std::size_t last, std::vector<FrameChain>& chains) const;
  BundleProblem problem_of(const FrameChain& chain) const;
  void turn_missing(const FrameChain& chain, BundleProblem& problem) const;
  void reweight(const FrameChain& chain, BundleProblem& problem) const;
  template <class Value>
  Value mean_around(const FrameChain& chain, std::size_t pose, const std::vector<Value>& values,
                    bool drifting_count) const;

  const InertialHistory& inertia_;
  const MapInertia estimates_;
  const double deviation_factor_;
  const bool scale_is_free_;
  const std::shared_ptr<const Camera> camera_;
  const std::map<double, KeyFrameId> keyframes_;  // by time stamp
  const double longest_prediction_;               // [s]
  Trajectory trajectory_;
  std::vector<Role> roles_;  // by frame of the trajectory
};

}  // namespace holdfast
