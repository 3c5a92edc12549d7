// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/evaluation/camera_angles.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "vertical_axis.hpp"

namespace holdfast {

namespace {

/// Roll, pitch and yaw [rad].
using Angles = Eigen::Vector3d;

/// The columns are the camera's forward, right and down directions in the world.
Eigen::Matrix3d forward_right_down(const Eigen::Matrix3d& R_world_camera) {
  Eigen::Matrix3d body;
  body << R_world_camera.col(2), R_world_camera.col(0), R_world_camera.col(1);
  return body;
}

/// The level frame: its columns are forward, right and down in the world, forward towards the first view.
Eigen::Matrix3d level_frame(const Eigen::Matrix3d& first, const Eigen::Vector3d& mean_up) {
  const auto axis = vertical_axis(mean_up);
  if (!axis) return first;
  Eigen::Matrix3d level;
  level.col(2) = Eigen::Vector3d::Unit(*axis) * (mean_up[*axis] > 0.0 ? -1.0 : 1.0);
  const auto horizontal = [&](const Eigen::Vector3d& direction) -> Eigen::Vector3d {
    return direction - level.col(2) * level.col(2).dot(direction);
  };
  Eigen::Vector3d forward = horizontal(first.col(0));
  constexpr double steep = 0.1;  // almost straight up or down: then the edge of the image tells the direction
  if (forward.norm() < steep) forward = horizontal(first.col(2)) * (first.col(0).dot(level.col(2)) > 0.0 ? -1.0 : 1.0);
  level.col(0) = forward.normalized();
  level.col(1) = level.col(2).cross(level.col(0));
  return level;
}

Angles angles_of(const Eigen::Matrix3d& R_level_body) {
  return {std::atan2(R_level_body(2, 1), R_level_body(2, 2)), std::asin(std::clamp(-R_level_body(2, 0), -1.0, 1.0)),
          std::atan2(R_level_body(1, 0), R_level_body(0, 0))};
}

/// The angles of the same rotation that are nearest to `reference`.
Angles nearest(const Angles& angles, const Angles& reference) {
  constexpr double half_turn = std::numbers::pi;
  const auto unwrapped = [&](Angles candidate) {
    for (int i = 0; i < 3; ++i)
      candidate[i] += 2.0 * half_turn * std::round((reference[i] - candidate[i]) / (2.0 * half_turn));
    return candidate;
  };
  // Every rotation has two sets of angles; beyond the vertical the second one continues the first.
  const Angles first = unwrapped(angles);
  const Angles second = unwrapped({angles[0] + half_turn, half_turn - angles[1], angles[2] + half_turn});
  return (second - reference).norm() < (first - reference).norm() ? second : first;
}

CameraAngles in_degrees(double timestamp, const Angles& angles) {
  const Angles degrees = angles * 180.0 / std::numbers::pi;
  return {timestamp, degrees[0], degrees[1], degrees[2]};
}

}  // namespace

EvaluatedAngles camera_angles(const Evaluation& evaluation) {
  EvaluatedAngles result;
  const Trajectory& truth = evaluation.truth_track;
  if (truth.empty()) return result;
  const Eigen::Matrix3d level =
      level_frame(forward_right_down(truth.front().T_world_camera.linear()), evaluation.mean_up);
  const auto measure = [&](const TimedPose& pose) {
    return angles_of(level.transpose() * forward_right_down(pose.T_world_camera.linear()));
  };
  std::vector<Angles> true_angles;
  for (const TimedPose& pose : truth) {
    const Angles angles = measure(pose);
    true_angles.push_back(true_angles.empty() ? angles : nearest(angles, true_angles.back()));
    result.truth.push_back(in_degrees(pose.timestamp, true_angles.back()));
  }
  std::size_t at = 0;
  for (const TimedPose& pose : evaluation.estimate_track) {
    const auto distance = [&](std::size_t i) { return std::abs(truth[i].timestamp - pose.timestamp); };
    while (at + 1 < truth.size() && distance(at + 1) <= distance(at)) ++at;
    result.estimate.push_back(in_degrees(pose.timestamp, nearest(measure(pose), true_angles[at])));
  }
  return result;
}

}  // namespace holdfast
