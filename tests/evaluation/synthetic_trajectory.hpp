// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <string>

#include "holdfast/core/random.hpp"
#include "holdfast/core/trajectory.hpp"

namespace holdfast::test {

/// A smooth curve that fills all three dimensions while the camera turns; `rate` poses per second.
inline Trajectory wavy_trajectory(int count, double rate, double begin = 100.0) {
  Trajectory trajectory;
  for (int i = 0; i < count; ++i) {
    const double t = i / rate;
    TimedPose pose;
    pose.timestamp = begin + t;
    pose.T_world_camera = Eigen::Translation3d(std::sin(t), 0.5 * std::cos(1.7 * t), 0.3 * std::sin(0.9 * t + 1.0)) *
                          Eigen::AngleAxisd(0.4 * std::sin(1.1 * t), Eigen::Vector3d(1, 2, 3).normalized());
    trajectory.push_back(pose);
  }
  return trajectory;
}

/// A camera on a straight line along x at a constant speed [m/s].
inline Trajectory straight_trajectory(int count, double rate, double speed, double begin = 0.0) {
  Trajectory trajectory;
  for (int i = 0; i < count; ++i) {
    TimedPose pose;
    pose.timestamp = begin + i / rate;
    pose.T_world_camera.translation().x() = speed * i / rate;
    trajectory.push_back(pose);
  }
  return trajectory;
}

/// Every pose moved by one similarity of the world.
inline Trajectory moved(Trajectory trajectory, const Eigen::Isometry3d& T_new_old, double scale = 1.0) {
  for (TimedPose& pose : trajectory) {
    pose.T_world_camera = T_new_old * pose.T_world_camera;
    pose.T_world_camera.translation() *= scale;
  }
  return trajectory;
}

inline Eigen::Isometry3d some_transform() {
  return Eigen::Translation3d(3.0, -2.0, 5.0) * Eigen::AngleAxisd(2.1, Eigen::Vector3d(-1, 0.5, 2).normalized());
}

}  // namespace holdfast::test
