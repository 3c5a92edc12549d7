// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/run/trajectory_journal.hpp"

#include <string>

#include "holdfast/core/error.hpp"

namespace holdfast {

namespace {

constexpr const char* file_name = "trajectory.txt";
constexpr const char* mark =
    "# The run has not come to its end: these are its poses as estimated, without later corrections.";

}  // namespace

TrajectoryJournal::TrajectoryJournal(const std::filesystem::path& folder) : stream_(folder / file_name) {
  stream_ << mark << '\n' << trajectory_header << std::flush;
  if (!stream_)
    throw InputError({(folder / file_name).string()}, "cannot be written; is the folder there, writable and not full?");
}

void TrajectoryJournal::add(const TimedPose& pose) {
  stream_ << pose_text(pose);
  if (since_flush_.seconds() < 1.0) return;
  stream_.flush();
  since_flush_.restart();
}

int poses_of_killed_run(const std::filesystem::path& folder) {
  std::ifstream stream(folder / file_name);
  std::string line;
  if (!std::getline(stream, line) || line != mark) return -1;
  int poses = 0;
  while (std::getline(stream, line)) poses += !line.empty() && line.front() != '#' ? 1 : 0;
  return poses;
}

}  // namespace holdfast
