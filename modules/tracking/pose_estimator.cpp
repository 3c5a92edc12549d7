// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/pose_estimator.hpp"

#include <algorithm>
#include <cmath>

#include "holdfast/interfaces/frame_observations.hpp"
#include "holdfast/matching/frame_features.hpp"

namespace holdfast {

void PoseEstimator::build_problem(Frame& frame) {
  moving_world_.weight_features(frame);
  problem_.clear();
  features_.clear();
  problem_.camera = frame.camera.get();
  problem_.T_camera_world = frame.T_camera_world;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    if (!frame.map_points[i].valid()) continue;
    const MapPoint* point = map_.find_point(frame.map_points[i]);
    if (point == nullptr) {
      frame.map_points[i] = MapPointId();
      continue;
    }
    add_observation(problem_, frame, i, point->position);
    features_.push_back(static_cast<std::uint32_t>(i));
  }
  problem_.inlier.assign(problem_.size(), 0);
}

int PoseEstimator::adjust(Frame& frame) {
  build_problem(frame);
  return solve(frame);
}

int PoseEstimator::adjust(Frame& frame, std::vector<OdometryMatch>& odometry) {
  build_problem(frame);
  // A feature that has found a map point since says more by that.
  std::erase_if(odometry, [&](const OdometryMatch& match) { return frame.map_points[match.feature].valid(); });
  for (const OdometryMatch& match : odometry) add_observation(problem_, frame, match.feature, match.position);
  problem_.inlier.assign(problem_.size(), 0);
  const int inliers = solve(frame);
  drop_outliers(frame);
  std::size_t observation = features_.size();
  std::erase_if(odometry, [&](const OdometryMatch&) { return problem_.inlier[observation++] == 0; });
  return inliers;
}

int PoseEstimator::solve(Frame& frame) {
  const PoseSummary summary = optimizer_.optimize_pose(problem_);
  position_deviation_ = summary.usable ? std::sqrt(summary.covariance.topLeftCorner<3, 3>().trace()) : 0.0;
  if (!summary.usable) {
    std::fill(problem_.inlier.begin(), problem_.inlier.end(), std::uint8_t{0});
    return 0;
  }
  frame.T_camera_world = problem_.T_camera_world;
  if (!moving_world_.weights_features()) return summary.inliers;
  // Features that are probably moving may agree by chance and do not support a pose.
  int inliers = 0;
  for (std::size_t i = 0; i < problem_.size(); ++i)
    inliers += problem_.inlier[i] != 0 && is_static(problem_.weight[i]) ? 1 : 0;
  return inliers;
}

void PoseEstimator::drop_outliers(Frame& frame) const {
  for (std::size_t i = 0; i < features_.size(); ++i)
    if (problem_.inlier[i] == 0) frame.map_points[features_[i]] = MapPointId();
}

}  // namespace holdfast
