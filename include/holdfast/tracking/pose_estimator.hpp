// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/moving_world/moving_world.hpp"
#include "holdfast/tracking/frame_matcher.hpp"

namespace holdfast {

/// Estimates the pose of a frame from its matches with map points, weighted by the probability that each feature is
/// static. Keeps its buffers; one thread. The caller holds the map's lock.
class PoseEstimator {
 public:
  /// All must outlive the estimator.
  PoseEstimator(Optimizer& optimizer, const MovingWorld& moving_world, const Map& map)
      : optimizer_(optimizer), moving_world_(moving_world), map_(map) {}

  /// Weights the frame's features and builds the motion-only problem of all its matches, which starts at the frame's
  /// pose. Matches with points that are gone are removed.
  void build_problem(Frame& frame);
  /// Builds the problem and adjusts the pose to it (motion-only bundle adjustment). Returns the number of inliers,
  /// without those that are probably moving; 0 leaves the pose as it was.
  int adjust(Frame& frame);
  /// The same with points that are not in the map beside those that are. Drops the outliers of both from the frame's
  /// matches and from `odometry`.
  int adjust(Frame& frame, std::vector<OdometryMatch>& odometry);
  /// Removes the matches that are outliers of the last problem.
  void drop_outliers(Frame& frame) const;

  /// The last problem, for other solvers; its inliers decide what drop_outliers() removes.
  PoseProblem& problem() { return problem_; }
  /// Number of matches in the last problem.
  int matches() const { return static_cast<int>(problem_.size()); }
  /// Standard deviation of the position that was last adjusted [m].
  double position_deviation() const { return position_deviation_; }

 private:
  int solve(Frame& frame);

  Optimizer& optimizer_;
  const MovingWorld& moving_world_;
  const Map& map_;
  PoseProblem problem_;
  std::vector<std::uint32_t> features_;  // of the problem's observations
  double position_deviation_ = 0.0;
};

}  // namespace holdfast
