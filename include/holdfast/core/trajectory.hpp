// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/core/build_layout.hpp"

namespace holdfast {

/// The camera pose at one time. T_world_camera maps points from the camera frame to the world frame.
struct TimedPose {
  double timestamp = 0.0;  ///< [s]
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
};

using Trajectory = std::vector<TimedPose>;

/// Sorts the poses by time stamp and removes duplicates: of several poses with the same stamp the last one is kept, as
/// in the TUM tools. Poses with a value that is not finite are also removed.
Trajectory sort_and_clean(Trajectory trajectory);

/// Reads a trajectory in TUM format: lines "timestamp tx ty tz qx qy qz qw", where '#' begins a comment. The result is
/// sorted and cleaned as by sort_and_clean(). Quaternions are normalised, zero ones skipped. Throws InputError (file,
/// line) for an unreadable file, for a line that is not a pose of 8 numbers separated by blanks, and for a quaternion
/// whose norm differs from 1 by more than 0.02. The message names the format that the line resembles. Commas, and a
/// comment that names qw first, are errors because they indicate another order of the quaternion.
Trajectory read_trajectory(const std::filesystem::path& file);

/// Format of the lines of a trajectory file.
enum class TrajectoryFormat {
  tum,    ///< "t tx ty tz qx qy qz qw", t in seconds
  kitti,  ///< 12 numbers: the upper three rows of T_world_camera, row by row; no stamp
  euroc,  ///< "t, tx, ty, tz, qw, qx, qy, qz", t in nanoseconds; further columns (velocity, biases) are not read. It is
          ///< recognised by its commas, or by a comment that names qw first
};

/// tum, kitti or euroc.
const char* trajectory_format_name(TrajectoryFormat format);
/// The format of that name, or nothing.
std::optional<TrajectoryFormat> find_trajectory_format(const std::string& name);

/// Options of read_trajectory_file().
struct TrajectoryReading {
  std::optional<TrajectoryFormat> format = TrajectoryFormat::tum;  ///< empty: recognised by the first pose of the file
  std::vector<double> stamps;  ///< time stamps of the poses of a KITTI file [s]; empty: 10 Hz, from 0
};

/// Content of a trajectory file, with counts of ignored poses.
struct TrajectoryFile {
  Trajectory poses;  ///< sorted and cleaned as by sort_and_clean()
  TrajectoryFormat format = TrajectoryFormat::tum;
  std::size_t not_finite = 0;
  std::size_t zero_quaternions = 0;
  std::size_t repeated_stamps = 0;  ///< poses replaced by a later pose with the same stamp

  /// The ignored poses as text, "2 poses that are not finite, 1 pose with a zero quaternion"; empty if there are none.
  std::string omissions() const;
};

/// Reads a trajectory in any of the formats as read_trajectory() does, and reports ignored lines. For KITTI's format it
/// also throws InputError if the numbers of poses and stamps differ, and for an invalid rotation matrix.
TrajectoryFile read_trajectory_file(const std::filesystem::path& file, const TrajectoryReading& reading = {});

/// The comment line that begins every file in TUM format that is written: the columns and their units.
inline constexpr const char* trajectory_header =
    "# timestamp [s] tx ty tz [m] qx qy qz qw, pose of the camera in the world\n";

/// Returns the line of one pose in TUM format, with 6 decimals for the time stamp and 9 for values, independent of the
/// locale. A value that is rounded to zero has no sign.
std::string pose_text(const TimedPose& pose);

/// Returns the trajectory in TUM format: trajectory_header, then pose_text() of every pose.
std::string trajectory_text(const Trajectory& trajectory);

/// Returns the trajectory in the given format; KITTI's has no time stamps.
std::string trajectory_text(const Trajectory& trajectory, TrajectoryFormat format);

/// Writes trajectory_text() atomically. Throws InputError if the file cannot be written.
void write_trajectory(const std::filesystem::path& file, const Trajectory& trajectory,
                      TrajectoryFormat format = TrajectoryFormat::tum);

/// Replaces the content of a file atomically: writes a temporary file in the same folder and renames it.
void write_file_atomically(const std::filesystem::path& file, const std::string& content);

}  // namespace holdfast
