// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/trajectory.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string_view>

#include "holdfast/core/error.hpp"

namespace holdfast {

namespace {

/// The numbers of a line, separated by blanks or commas; '#' begins a comment. False for a word that is no number.
bool parse_numbers(std::string_view line, std::vector<double>& numbers) {
  numbers.clear();
  line = line.substr(0, line.find('#'));
  while (true) {
    const std::size_t begin = line.find_first_not_of(" \t\r,");
    if (begin == std::string_view::npos) return true;
    const std::size_t end = std::min(line.find_first_of(" \t\r,", begin), line.size());
    std::string_view word = line.substr(begin, end - begin);
    if (word.front() == '+') word.remove_prefix(1);
    double value = 0.0;
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || stop != word.data() + word.size()) return false;
    numbers.push_back(value);
    line.remove_prefix(end);
  }
}

}  // namespace

Trajectory read_trajectory(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream || std::filesystem::is_directory(file))
    throw InputError({file.string()}, "cannot be read; expected a trajectory in TUM format (t tx ty tz qx qy qz qw)");
  Trajectory trajectory;
  std::string line;
  std::vector<double> numbers;
  for (int line_number = 1; std::getline(stream, line); ++line_number) {
    const bool parsed = parse_numbers(line, numbers);
    if (parsed && numbers.empty()) continue;
    if (!parsed || numbers.size() < 8)
      throw InputError({file.string(), line_number},
                       "found '" + line.substr(0, 60) + "'; expected 8 numbers: t tx ty tz qx qy qz qw");
    const bool finite = std::all_of(numbers.begin(), numbers.begin() + 8, [](double v) { return std::isfinite(v); });
    Eigen::Quaterniond rotation(numbers[7], numbers[4], numbers[5], numbers[6]);
    if (!finite || rotation.norm() == 0.0) continue;
    TimedPose pose;
    pose.timestamp = numbers[0];
    pose.T_world_camera = Eigen::Translation3d(numbers[1], numbers[2], numbers[3]) * rotation.normalized();
    trajectory.push_back(pose);
  }
  std::stable_sort(trajectory.begin(), trajectory.end(),
                   [](const TimedPose& a, const TimedPose& b) { return a.timestamp < b.timestamp; });
  Trajectory unique;
  for (const TimedPose& pose : trajectory) {
    if (!unique.empty() && unique.back().timestamp == pose.timestamp) unique.back() = pose;
    else unique.push_back(pose);
  }
  return unique;
}

void write_trajectory(const std::filesystem::path& file, const Trajectory& trajectory) {
  std::string text;
  char line[256];
  for (const TimedPose& pose : trajectory) {
    const Eigen::Vector3d t = pose.T_world_camera.translation();
    Eigen::Quaterniond q(pose.T_world_camera.linear());
    q.normalize();
    if (q.w() < 0.0) q.coeffs() = -q.coeffs();
    std::snprintf(line, sizeof(line), "%.6f %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n", pose.timestamp, t.x(), t.y(), t.z(),
                  q.x(), q.y(), q.z(), q.w());
    text += line;
  }
  write_file_atomically(file, text);
}

void write_file_atomically(const std::filesystem::path& file, const std::string& content) {
  std::filesystem::path temporary = file;
  temporary += ".tmp";
  {
    std::ofstream stream(temporary, std::ios::binary);
    stream.write(content.data(), static_cast<std::streamsize>(content.size()));
    stream.flush();
    if (!stream) throw InputError({temporary.string()}, "cannot be written; is the folder there, writable and not full?");
  }
  std::error_code error;
  std::filesystem::rename(temporary, file, error);
  if (error) throw InputError({file.string()}, "cannot be replaced: " + error.message());
}

}  // namespace holdfast
