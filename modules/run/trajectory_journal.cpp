// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/run/trajectory_journal.hpp"

#include <string>
#include <system_error>

#include "holdfast/core/error.hpp"
#include "holdfast/core/input_file.hpp"
#include "holdfast/core/system_reason.hpp"
#include "holdfast/core/text_file.hpp"

namespace holdfast {

namespace {

constexpr const char* expected = "a trajectory";
constexpr const char* file_name = "trajectory.txt";
constexpr const char* mark =
    "# The run has not come to its end: these are its poses as estimated, without later corrections.";

}  // namespace

TrajectoryJournal::TrajectoryJournal(const std::filesystem::path& folder) : stream_(folder / file_name) {
  stream_ << mark << '\n' << trajectory_header << std::flush;
  if (!stream_) throw InputError({(folder / file_name).string()}, "cannot be written: " + system_reason(errno));
}

void TrajectoryJournal::add(const TimedPose& pose) {
  stream_ << pose_text(pose);
  if (since_flush_.seconds() < 1.0) return;
  stream_.flush();
  since_flush_.restart();
}

bool is_trajectory_journal(const std::filesystem::path& file) {
  if (!why_unreadable(file, largest_file::text).empty()) return false;
  LineReader lines(file, expected);
  std::string line;
  return lines.next(line) && line == mark;
}

int poses_of_killed_run(const std::filesystem::path& folder) {
  std::error_code error;
  if (!std::filesystem::exists(folder / file_name, error)) return -1;
  LineReader lines(folder / file_name, expected);
  std::string line;
  if (!lines.next(line) || line != mark) return -1;
  int poses = 0;
  while (lines.next(line)) poses += !line.empty() && line.front() != '#' ? 1 : 0;
  return poses;
}

}  // namespace holdfast
