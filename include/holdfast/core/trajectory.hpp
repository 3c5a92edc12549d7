// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

namespace holdfast {

/// The pose of the camera at a time. T_world_camera maps points from the camera frame to the world frame.
struct TimedPose {
  double timestamp = 0.0;  ///< [s]
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
};

using Trajectory = std::vector<TimedPose>;

/// The poses sorted by stamp, each stamp once: of several poses with one stamp the last one counts, as in the TUM
/// tools. Poses with a value that is not finite are left out, as there.
Trajectory sort_and_clean(Trajectory trajectory);

/// Reads a trajectory in TUM format: lines "timestamp tx ty tz qx qy qz qw", '#' begins a comment, further words are
/// ignored. The result is sorted and cleaned as by sort_and_clean(); quaternions are normalised, lines with a zero one
/// are left out. Throws InputError (file and line) for a file that cannot be read or a line that is no pose.
Trajectory read_trajectory(const std::filesystem::path& file);

/// TUM format, stamps with 6 decimals and values with 9. The same bytes whatever the process's locale.
std::string trajectory_text(const Trajectory& trajectory);

/// Writes trajectory_text() to a temporary name first, then renames. Throws InputError when the file cannot be written.
void write_trajectory(const std::filesystem::path& file, const Trajectory& trajectory);

/// Replaces the content of a file in one step: written to a temporary name beside it, then renamed.
void write_file_atomically(const std::filesystem::path& file, const std::string& content);

}  // namespace holdfast
