// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/moving_world/moving_world.hpp"
#include "holdfast/tracking/frame_matcher.hpp"
#include "holdfast/tracking/tracking_settings.hpp"

namespace holdfast {

/// Estimates the pose of a frame from its matches with map points, weighted by the probability that each feature is
/// static. Keeps its buffers; one thread, within a MapAccess.
///
/// Established points take precedence in monocular mode with filters: unmasked parts of people also create map points,
/// which are consistent with each other and, being near, dominate the translation. If the points created at least
/// TrackingSettings::established_age ago determine the pose, newer points that contradict it are outliers. With depth,
/// filters measure the motion instead.
class PoseEstimator {
 public:
  /// All must outlive the estimator.
  PoseEstimator(const TrackingSettings& settings, Optimizer& optimizer, MovingWorld& moving_world, const Map& map)
      : settings_(settings), optimizer_(optimizer), moving_world_(moving_world), map_(map) {}

  /// Weights the frame's features and builds the motion-only problem of all matches with the frame's pose as initial
  /// value. Matches with removed points are dropped.
  void build_problem(Frame& frame);
  /// Builds the problem and optimizes the pose (motion-only bundle adjustment). Returns the number of inliers that are
  /// probably static; if it is 0, the pose is unchanged.
  int adjust(Frame& frame);
  /// Like adjust(), with odometry points in addition to map points. Removes the outliers from the frame's matches and
  /// from `odometry`.
  int adjust(Frame& frame, std::vector<OdometryMatch>& odometry);
  /// Like adjust() for a frame that is not the current one; the weights of its features are not changed.
  int adjust_as_weighted(Frame& frame, std::vector<OdometryMatch>& odometry);
  /// Removes the matches that are outliers of the last problem.
  void drop_outliers(Frame& frame) const;

  /// The last problem, for other solvers. Its inlier flags determine the matches that drop_outliers() removes.
  PoseProblem& problem() { return problem_; }
  const PoseProblem& problem() const { return problem_; }
  /// Number of matches in the last problem.
  int matches() const { return static_cast<int>(problem_.size()); }
  /// Standard deviation of the last adjusted position [m].
  double position_deviation() const { return position_deviation_; }
  /// Covariance of the pose that was last adjusted, of the matches alone: translation [m] and rotation [rad] of
  /// FrameResult::covariance, or of a left perturbation of T_camera_world. Empty if none was determined.
  const std::optional<Eigen::Matrix<double, 6, 6>>& covariance() const { return covariance_; }

 private:
  void collect_observations(Frame& frame);
  int solve(Frame& frame);
  bool is_established(const MapPoint& point, double now) const;
  void reject_new_points(const Frame& frame);

  const TrackingSettings& settings_;
  Optimizer& optimizer_;
  MovingWorld& moving_world_;
  const Map& map_;
  PoseProblem problem_;
  std::vector<std::uint32_t> features_;  // of the problem's observations
  PoseProblem established_;              // the observations of established points
  std::vector<std::uint8_t> rejected_;   // by the problem's observations: new points that contradict established ones
  double position_deviation_ = 0.0;
  std::optional<Eigen::Matrix<double, 6, 6>> covariance_;
};

}  // namespace holdfast
