// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "holdfast/core/counted.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/parsed_number.hpp"
#include "holdfast/core/stamp_unit.hpp"
#include "holdfast/core/text_file.hpp"

namespace holdfast {

namespace {

/// The words of a line, separated by blanks or commas; '#' begins a comment. A column with nothing between its commas
/// is an empty word.
void split(std::string_view line, std::vector<std::string_view>& words) {
  words.clear();
  line = line.substr(0, line.find('#'));
  while (true) {
    const std::size_t begin = line.find_first_not_of(" \t\r,");
    if (begin == std::string_view::npos) return;
    const auto commas = std::count(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(begin), ',');
    for (auto i = words.empty() ? 0 : 1; i < commas; ++i) words.emplace_back();
    const std::size_t end = std::min(line.find_first_of(" \t\r,", begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    line.remove_prefix(end);
  }
}

/// Returns false if one of the words is not a number.
bool parse_numbers(const std::vector<std::string_view>& words, std::vector<double>& numbers) {
  numbers.clear();
  for (std::string_view word : words) {
    if (word.starts_with('+')) word.remove_prefix(1);
    const auto value = parsed_number<double>(word);
    if (!value) return false;
    numbers.push_back(*value);
  }
  return true;
}

/// Upper bound of plausible seconds.
bool is_in_nanoseconds(double stamp) { return std::isfinite(stamp) && stamp >= 1e14; }
constexpr double least_nanoseconds_since_1970 = 1e17;  // in 1973

/// Whether a comment names the columns of a pose with the quaternion's real part before the others ("qw qx qy qz",
/// "q_w [],q_x []", "q_RS_w").
bool names_real_part_first(std::string_view comment) {
  const auto first_of = [&](std::initializer_list<std::string_view> names) {
    std::size_t first = std::string_view::npos;
    for (const std::string_view name : names) first = std::min(first, comment.find(name));
    return first;
  };
  const std::size_t real = first_of({"qw", "q_w", "q_RS_w"}), imaginary = first_of({"qx", "q_x", "q_RS_x"});
  return real != std::string_view::npos && imaginary != std::string_view::npos && real < imaginary;
}

/// Describes why eight numbers may not be a pose in the format of their time stamps, although they can be read as one:
/// the position of the quaternion's real part depends on the format and cannot be recognised by its value.
std::string doubt(TrajectoryFormat format, double stamp, bool has_commas, bool real_part_first) {
  if (format == TrajectoryFormat::tum && has_commas)
    return "numbers are separated by commas, as in EuRoC's format, where the quaternion begins with qw, but its stamps "
           "are in nanoseconds; where it ends with qw, replace the commas by blanks";
  if (format == TrajectoryFormat::tum && real_part_first)
    return "a comment above says that the quaternion begins with qw";
  if (format == TrajectoryFormat::euroc && !has_commas && !real_part_first && stamp < least_nanoseconds_since_1970)
    return "stamps " + stamp_magnitude_suspicion(stamp) + ", or by 1e9 where they are nanoseconds of another clock";
  if (format == TrajectoryFormat::euroc && !has_commas && !real_part_first)
    return "stamps are in nanoseconds, as in EuRoC's format, but without its commas; ORB-SLAM3 writes such files, with "
           "qw at the end: divide their stamps by 1e9";
  return {};
}

/// Probable format of a line; nothing if it is unknown. `in_nanoseconds`: a comment of the file says so.
std::optional<TrajectoryFormat> looks_like(const std::vector<double>& numbers, bool in_nanoseconds) {
  if (in_nanoseconds && numbers.size() >= 8) return TrajectoryFormat::euroc;
  if (numbers.size() == 12) return TrajectoryFormat::kitti;
  if (numbers.size() >= 8 && is_in_nanoseconds(numbers.front())) return TrajectoryFormat::euroc;
  if (numbers.size() == 8) return TrajectoryFormat::tum;
  return std::nullopt;
}

const char* description(TrajectoryFormat format) {
  switch (format) {
    case TrajectoryFormat::kitti:
      return "KITTI's format (12 numbers of a matrix, without a stamp)";
    case TrajectoryFormat::euroc:
      return "EuRoC's format (stamps in nanoseconds, then tx ty tz qw qx qy qz, separated by commas)";
    case TrajectoryFormat::tum:
      break;
  }
  return "TUM format (t tx ty tz qx qy qz qw, t in seconds, separated by blanks)";
}

/// The same for a line that is of another format than expected.
std::string description_of_line(TrajectoryFormat format, const std::string& line, const std::vector<double>& numbers) {
  const bool may_be_tum =
      format == TrajectoryFormat::euroc && numbers.size() == 8 && line.find(',') == std::string::npos;
  if (may_be_tum && numbers.front() < least_nanoseconds_since_1970)
    if (const std::string unit = stamp_magnitude_suspicion(numbers.front()); !unit.empty())
      return "TUM format, but the time stamps " + unit;
  return description(format);
}

/// Appends a number with a fixed number of decimals and a decimal point, independent of the locale. A number that is
/// rounded to zero has no sign.
void append_fixed(std::string& text, double value, int decimals) {
  char buffer[400];
  const auto [end, error] = std::to_chars(buffer, buffer + sizeof(buffer), value, std::chars_format::fixed, decimals);
  std::string_view number(buffer, error == std::errc() ? static_cast<std::size_t>(end - buffer) : 0);
  if (number.starts_with('-') && number.find_first_not_of("-0.") == std::string_view::npos) number.remove_prefix(1);
  text += number;
}

/// The rotation matrix of a line in KITTI's format.
Eigen::Matrix3d rotation_matrix_of(const std::vector<double>& n) {
  Eigen::Matrix3d rotation;
  rotation << n[0], n[1], n[2], n[4], n[5], n[6], n[8], n[9], n[10];
  return rotation;
}

/// Pose of the numbers of a line; for KITTI the caller sets the stamp. Its quaternion may be zero.
std::pair<Eigen::Vector3d, Eigen::Quaterniond> pose_of(const std::vector<double>& n, TrajectoryFormat format) {
  if (format == TrajectoryFormat::tum) return {{n[1], n[2], n[3]}, {n[7], n[4], n[5], n[6]}};
  if (format == TrajectoryFormat::euroc) return {{n[1], n[2], n[3]}, {n[4], n[5], n[6], n[7]}};
  const Eigen::Matrix3d rotation = rotation_matrix_of(n);
  if (rotation.isZero(0.0)) return {{n[3], n[7], n[11]}, {0.0, 0.0, 0.0, 0.0}};
  return {{n[3], n[7], n[11]}, Eigen::Quaterniond(rotation)};
}

/// Describes why the numbers of a line are no rotation, and their probable meaning; empty for a rotation with two
/// decimals or more, and for values that are not finite.
std::string rotation_trouble(const std::vector<double>& n, TrajectoryFormat format,
                             const Eigen::Quaterniond& quaternion) {
  constexpr double rounding = 0.02;
  if (format != TrajectoryFormat::kitti) {
    const double length = quaternion.norm();
    if (!std::isfinite(length) || std::abs(length - 1.0) <= rounding) return {};
    std::string text;
    append_fixed(text, length, length < 0.1 ? 6 : 3);
    return "four numbers of length " + text +
           " where a unit quaternion should be; are they Euler angles, a rotation vector, or other columns?";
  }
  const Eigen::Matrix3d rotation = rotation_matrix_of(n);
  if (!rotation.allFinite()) return {};
  const Eigen::Matrix3d product = rotation.transpose() * rotation;
  std::string text;
  if (const double error = (product - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(); error > 2.0 * rounding) {
    append_fixed(text, std::sqrt(product.trace() / 3.0), 6);
    const bool is_scaled = (product - product.trace() / 3.0 * Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <
                           2.0 * rounding * product.trace() / 3.0;
    return is_scaled ? "a rotation matrix that is scaled by " + text + "; divide its nine numbers by that"
                     : std::string(
                           "a 3 x 3 matrix that is no rotation; are the 12 numbers the upper rows of a 4 x 4 "
                           "matrix, row by row?");
  }
  if (rotation.determinant() < 0.0)
    return "a matrix that mirrors (determinant -1), as in a left-handed frame; change the sign of one axis";
  return {};
}

constexpr const char* expected_format = "a trajectory in TUM format (t tx ty tz qx qy qz qw)";

}  // namespace

Trajectory sort_and_clean(Trajectory trajectory) {
  std::erase_if(trajectory, [](const TimedPose& pose) {
    return !std::isfinite(pose.timestamp) || !pose.T_world_camera.matrix().allFinite();
  });
  std::stable_sort(trajectory.begin(), trajectory.end(),
                   [](const TimedPose& a, const TimedPose& b) { return a.timestamp < b.timestamp; });
  Trajectory unique;
  unique.reserve(trajectory.size());
  for (const TimedPose& pose : trajectory) {
    if (!unique.empty() && unique.back().timestamp == pose.timestamp)
      unique.back() = pose;
    else
      unique.push_back(pose);
  }
  return unique;
}

Trajectory read_trajectory(const std::filesystem::path& file) { return read_trajectory_file(file).poses; }

std::string TrajectoryFile::omissions() const {
  std::string text;
  const auto add = [&](std::size_t count, const char* what) {
    if (count > 0)
      text += (text.empty() ? "" : ", ") + std::to_string(count) + (count == 1 ? " pose " : " poses ") + what;
  };
  add(not_finite, not_finite == 1 ? "that is not finite" : "that are not finite");
  add(zero_quaternions, "with a zero quaternion");
  add(repeated_stamps, "with the stamp of a later line");
  return text;
}

const char* trajectory_format_name(TrajectoryFormat format) {
  return format == TrajectoryFormat::tum ? "tum" : format == TrajectoryFormat::kitti ? "kitti" : "euroc";
}

std::optional<TrajectoryFormat> find_trajectory_format(const std::string& name) {
  for (const TrajectoryFormat format : {TrajectoryFormat::tum, TrajectoryFormat::kitti, TrajectoryFormat::euroc})
    if (name == trajectory_format_name(format)) return format;
  return std::nullopt;
}

TrajectoryFile read_trajectory_file(const std::filesystem::path& file, const TrajectoryReading& reading) {
  LineReader lines(file, expected_format);
  TrajectoryFile result;
  Trajectory trajectory;
  std::string line;
  std::vector<std::string_view> words;
  std::vector<double> numbers;
  std::optional<TrajectoryFormat> format = reading.format;
  constexpr double kitti_interval = 0.1;  // s
  std::size_t pose_number = 0;
  bool in_nanoseconds = reading.format == TrajectoryFormat::euroc, real_part_first = in_nanoseconds;
  while (lines.next(line)) {
    // The header of EuRoC's files; stamps that begin at 0 look like seconds.
    if (line.starts_with('#') && line.find("[ns]") != std::string::npos) in_nanoseconds = true;
    if (line.starts_with('#') && names_real_part_first(line)) real_part_first = true;
    split(line, words);
    if (words.empty()) continue;
    const bool parsed = parse_numbers(words, numbers);
    const std::optional<TrajectoryFormat> found = parsed ? looks_like(numbers, in_nanoseconds) : std::nullopt;
    if (!format) format = found;
    if (!found || found != format)
      throw InputError(lines.location(),
                       "found " + counted(words.size(), "column") + ", '" + line.substr(0, 60) + "'" +
                           (found ? "; it looks like " + description_of_line(*found, line, numbers) : "") +
                           "; expected " + description(format.value_or(TrajectoryFormat::tum)) + "; convert the file");
    const std::string_view content = std::string_view(line).substr(0, line.find('#'));
    if (const std::string reason =
            doubt(*format, numbers.front(), content.find(',') != std::string_view::npos, real_part_first);
        !reason.empty())
      throw InputError(lines.location(), "found '" + line.substr(0, 60) + "': " + reason + "; expected " +
                                             description(*format) + "; convert the file");
    result.format = *format;
    const auto [position, rotation] = pose_of(numbers, *format);
    const std::size_t number = pose_number++;
    if (rotation.norm() == 0.0) {
      ++result.zero_quaternions;
      continue;
    }
    if (const std::string trouble = rotation_trouble(numbers, *format, rotation); !trouble.empty())
      throw InputError(lines.location(),
                       "found " + trouble + " Found '" + line.substr(0, 160) + "'; expected " + description(*format));
    TimedPose pose;
    pose.timestamp = numbers[0];
    if (format == TrajectoryFormat::euroc) pose.timestamp = numbers[0] * 1e-9;
    if (format == TrajectoryFormat::kitti) {
      if (!reading.stamps.empty() && number >= reading.stamps.size())
        throw InputError(lines.location(), "found more poses than the " + std::to_string(reading.stamps.size()) +
                                               " time stamps; expected one stamp for each pose");
      pose.timestamp = reading.stamps.empty() ? kitti_interval * static_cast<double>(number) : reading.stamps[number];
    }
    pose.T_world_camera = Eigen::Translation3d(position) * rotation.normalized();
    if (!std::isfinite(pose.timestamp) || !pose.T_world_camera.matrix().allFinite()) {
      ++result.not_finite;
      continue;
    }
    trajectory.push_back(pose);
  }
  if (result.format == TrajectoryFormat::kitti && !reading.stamps.empty() && pose_number != reading.stamps.size())
    throw InputError({file.string()}, "found " + counted(pose_number, "pose") + " for " +
                                          std::to_string(reading.stamps.size()) +
                                          " time stamps; expected one stamp for each pose");
  const std::size_t count = trajectory.size();
  result.poses = sort_and_clean(std::move(trajectory));
  result.repeated_stamps = count - result.poses.size();
  return result;
}

std::string pose_text(const TimedPose& pose) {
  const Eigen::Vector3d t = pose.T_world_camera.translation();
  Eigen::Quaterniond q(pose.T_world_camera.linear());
  q.normalize();
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  std::string text;
  append_fixed(text, pose.timestamp, 6);
  for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) {
    text += ' ';
    append_fixed(text, value, 9);
  }
  return text += '\n';
}

std::string trajectory_text(const Trajectory& trajectory) {
  std::string text = trajectory_header;
  for (const TimedPose& pose : trajectory) text += pose_text(pose);
  return text;
}

std::string trajectory_text(const Trajectory& trajectory, TrajectoryFormat format) {
  if (format == TrajectoryFormat::tum) return trajectory_text(trajectory);
  std::string text;
  if (format == TrajectoryFormat::euroc) text = "#timestamp [ns],p_x [m],p_y [m],p_z [m],q_w [],q_x [],q_y [],q_z []\n";
  for (const TimedPose& pose : trajectory) {
    const auto matrix = pose.T_world_camera.matrix();
    if (format == TrajectoryFormat::kitti) {
      for (int i = 0; i < 12; ++i) {
        if (i > 0) text += ' ';
        append_fixed(text, matrix(i / 4, i % 4), 9);
      }
    } else {
      Eigen::Quaterniond q(pose.T_world_camera.linear());
      q.normalize();
      if (q.w() < 0.0) q.coeffs() = -q.coeffs();
      append_fixed(text, std::round(pose.timestamp * 1e9), 0);
      for (const double value : {matrix(0, 3), matrix(1, 3), matrix(2, 3), q.w(), q.x(), q.y(), q.z()}) {
        text += ',';
        append_fixed(text, value, 9);
      }
    }
    text += '\n';
  }
  return text;
}

void write_trajectory(const std::filesystem::path& file, const Trajectory& trajectory, TrajectoryFormat format) {
  write_file_atomically(file, trajectory_text(trajectory, format));
}

}  // namespace holdfast
