// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/pose_estimator.hpp"

#include <algorithm>
#include <cmath>

#include "holdfast/interfaces/frame_observations.hpp"
#include "holdfast/matching/frame_features.hpp"

namespace holdfast {

namespace {

int count_static_inliers(const PoseProblem& problem) {
  int inliers = 0;
  for (std::size_t i = 0; i < problem.size(); ++i)
    inliers += problem.inlier[i] != 0 && is_static(problem.weight[i]) ? 1 : 0;
  return inliers;
}

}  // namespace

void PoseEstimator::build_problem(Frame& frame) {
  moving_world_.weight_features(frame);
  collect_observations(frame);
}

void PoseEstimator::collect_observations(Frame& frame) {
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
  moving_world_.weight_features(frame);
  return adjust_as_weighted(frame, odometry);
}

int PoseEstimator::adjust_as_weighted(Frame& frame, std::vector<OdometryMatch>& odometry) {
  collect_observations(frame);
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

bool PoseEstimator::is_established(const MapPoint& point, double now) const {
  const KeyFrame* first = map_.find_keyframe(point.reference_keyframe);
  if (first == nullptr) return false;
  const double age = now - first->frame.timestamp;
  return age >= settings_.established_age || age < 0.0;  // a loaded map may be of a later recording
}

void PoseEstimator::reject_new_points(const Frame& frame) {
  rejected_.assign(problem_.size(), 1);
  established_.clear();
  established_.camera = problem_.camera;
  established_.T_camera_world = problem_.T_camera_world;
  for (std::size_t i = 0; i < features_.size(); ++i) {
    if (!is_established(map_.point(frame.map_points[features_[i]]), frame.timestamp)) continue;
    rejected_[i] = 0;
    add_observation(established_, frame, features_[i], problem_.points[i]);
  }
  established_.inlier.assign(established_.size(), 0);
  const int needed = settings_.established_points;
  const bool decides = static_cast<int>(established_.size()) >= needed && established_.size() < problem_.size() &&
                       optimizer_.optimize_pose(established_).usable && count_static_inliers(established_) >= needed;
  if (!decides) {
    rejected_.clear();
    return;
  }
  problem_.T_camera_world = established_.T_camera_world;
  const double max_error = settings_.new_point_factor * geometry::chi_square_two;
  for (std::size_t i = 0; i < rejected_.size(); ++i) {
    if (rejected_[i] == 0) continue;
    const Eigen::Vector3d point = problem_.T_camera_world * problem_.points[i];
    const Eigen::Vector2d error = problem_.camera->project(point) - Eigen::Vector2d(problem_.x[i], problem_.y[i]);
    rejected_[i] = !(point.z() > 0.0) || error.squaredNorm() * problem_.inverse_sigma2[i] >= max_error ? 1 : 0;
    if (rejected_[i] != 0) problem_.weight[i] = 0.0F;
  }
}

int PoseEstimator::solve(Frame& frame) {
  rejected_.clear();
  if (!features_have_depth(map_.sensor()) && moving_world_.weights_features()) reject_new_points(frame);
  const PoseSummary summary = optimizer_.optimize_pose(problem_);
  position_deviation_ = summary.usable ? std::sqrt(summary.covariance.topLeftCorner<3, 3>().trace()) : 0.0;
  covariance_ = summary.usable ? std::optional(summary.covariance) : std::nullopt;
  if (!summary.usable) {
    std::fill(problem_.inlier.begin(), problem_.inlier.end(), std::uint8_t{0});
    return 0;
  }
  frame.T_camera_world = problem_.T_camera_world;
  for (std::size_t i = 0; i < rejected_.size(); ++i)
    if (rejected_[i] != 0) problem_.inlier[i] = 0;
  // Features that are probably moving may agree by chance and do not support a pose.
  return moving_world_.weights_features() ? count_static_inliers(problem_) : summary.inliers;
}

void PoseEstimator::drop_outliers(Frame& frame) const {
  for (std::size_t i = 0; i < features_.size(); ++i)
    if (problem_.inlier[i] == 0) frame.map_points[features_[i]] = MapPointId();
}

}  // namespace holdfast
