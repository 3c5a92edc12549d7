// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/trajectory_smoothing.hpp"

#include <Eigen/Geometry>
#include <vector>

#include "holdfast/geometry/path_smoothing.hpp"
#include "holdfast/geometry/so3.hpp"

namespace holdfast {

Trajectory smooth_trajectory(const Trajectory& trajectory) {
  std::vector<double> times;
  std::vector<Eigen::Vector3d> positions, turns;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    times.push_back(trajectory[i].timestamp);
    positions.push_back(trajectory[i].T_world_camera.translation());
    if (i == 0)
      turns.push_back(Eigen::Vector3d::Zero());
    else
      turns.push_back(turns.back() + geometry::log_so3(trajectory[i].T_world_camera.linear() *
                                                       trajectory[i - 1].T_world_camera.linear().transpose()));
  }
  const std::vector<Eigen::Vector3d> smoothed = geometry::smooth_path(times, positions);
  const std::vector<Eigen::Vector3d> smoothed_turns = geometry::smooth_path(times, turns);
  Trajectory result = trajectory;
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i].T_world_camera.translation() = smoothed[i];
    result[i].T_world_camera.linear() =
        geometry::exp_so3(smoothed_turns[i] - turns[i]) * trajectory[i].T_world_camera.linear();
  }
  return result;
}

void smooth_trajectory(FrameHistory& history, const Map& map) {
  for (const TimedPose& pose : smooth_trajectory(history.trajectory(map)))
    history.replace(pose.timestamp, pose.T_world_camera.inverse(), map);
}

}  // namespace holdfast
