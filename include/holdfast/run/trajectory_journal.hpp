// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <fstream>

#include "holdfast/core/stage_times.hpp"
#include "holdfast/core/trajectory.hpp"

namespace holdfast {

/// Writes the poses during a run, so that they survive if it is killed: trajectory.txt in TUM format, one line a pose,
/// flushed each second. A comment at its head marks the run as unfinished; write_results() replaces the file by the
/// corrected trajectory. Used by one thread.
class TrajectoryJournal {
 public:
  /// Begins `folder`/trajectory.txt. Throws InputError if the file cannot be written.
  explicit TrajectoryJournal(const std::filesystem::path& folder);
  /// Adds an estimated pose. Poses that cannot be written, as on a full disk, are dropped without ending the run;
  /// write_results() reports the error.
  void add(const TimedPose& pose);

 private:
  std::ofstream stream_;
  Stopwatch since_flush_;
};

/// Whether a trajectory file is the journal of a killed or running run. False for anything but a regular file.
bool is_trajectory_journal(const std::filesystem::path& file);

/// Number of poses that a killed run has left in a folder; -1 if the folder does not hold such a run.
int poses_of_killed_run(const std::filesystem::path& folder);

}  // namespace holdfast
