// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/recorded_imu.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>

#include "holdfast/core/imu_plausibility.hpp"
#include "holdfast/core/parsed_number.hpp"
#include "holdfast/core/stamp_unit.hpp"
#include "holdfast/core/text_file.hpp"
#include "holdfast/image_files/image_list.hpp"

namespace holdfast {

namespace {

constexpr const char* expected_line =
    "expected lines of seven numbers: time stamp, angular velocity x, y, z [rad/s], specific force x, y, z [m/s^2]";

std::vector<std::string_view> split_numbers(std::string_view line) {
  constexpr const char* separators = " \t\r,;";
  std::vector<std::string_view> words;
  for (std::size_t begin = line.find_first_not_of(separators); begin != std::string_view::npos;
       begin = line.find_first_not_of(separators, begin)) {
    const std::size_t end = std::min(line.find_first_of(separators, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = end;
  }
  return words;
}

double parsed(std::string_view word, const SourceLocation& place) {
  const auto value = parsed_number<double>(word);
  if (!value || !std::isfinite(*value))
    throw InputError(place, "found '" + std::string(word.substr(0, 40)) + "'; " + expected_line +
                                "; correct the line or take it out");
  return *value;
}

/// Seconds; whole numbers beyond any second are nanoseconds, as in the ASL layout.
double parsed_stamp(std::string_view word, const SourceLocation& place) {
  constexpr std::int64_t least_nanoseconds = 100'000'000'000'000'000;  // in the year 1973
  if (const auto whole = parsed_number<std::int64_t>(word); whole && *whole >= least_nanoseconds)
    return static_cast<double>(*whole) * 1e-9;
  const double seconds = parsed(word, place);
  if (const std::string unit = stamp_magnitude_suspicion(seconds); !unit.empty())
    throw InputError(place, "found the time stamp '" + std::string(word) +
                                "', but time stamps are seconds or whole nanoseconds; they " + unit);
  return seconds;
}

/// A first line of names that begin with letters. Names that put the accelerometer first are an error.
bool names_columns(std::string_view line, const SourceLocation& place) {
  const std::vector<std::string_view> names = split_numbers(line);
  const auto is_letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '"'; };
  if (names.size() < 7 || !is_letter(names[0].front()) || !is_letter(names[1].front())) return false;
  std::string second = names.size() > 1 ? std::string(names[1]) : "";
  std::transform(second.begin(), second.end(), second.begin(), [](unsigned char c) { return std::tolower(c); });
  if (second.find("acc") != std::string::npos || second == "ax" || second == "\"ax\"" || second.starts_with("a_"))
    throw InputError(place, "names the acceleration '" + std::string(names[1]) +
                                "' before the angular velocity; expected the angular velocity in columns 2 to 4, the "
                                "acceleration in columns 5 to 7; exchange the columns");
  return true;
}

ImuSample parsed_sample(std::string_view line, const SourceLocation& place) {
  const std::vector<std::string_view> words = split_numbers(line);
  if (words.size() != 7)
    throw InputError(place, "found " + std::to_string(words.size()) + " values in '" + std::string(line.substr(0, 80)) +
                                "'; " + expected_line + "; correct the line or take it out");
  ImuSample sample;
  sample.timestamp = parsed_stamp(words[0], place);
  for (std::size_t i = 0; i < 3; ++i) {
    sample.angular_velocity[static_cast<int>(i)] = parsed(words[1 + i], place);
    sample.acceleration[static_cast<int>(i)] = parsed(words[4 + i], place);
  }
  return sample;
}

}  // namespace

std::string imu_sample_text(const ImuSample& sample) {
  const Eigen::Vector3d &w = sample.angular_velocity, &a = sample.acceleration;
  std::string text;
  for (const double value : {sample.timestamp, w.x(), w.y(), w.z(), a.x(), a.y(), a.z()}) {
    std::array<char, 400> digits{};  // of any double
    const auto end = text.empty()
                         ? std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed)
                         : std::to_chars(digits.data(), digits.data() + digits.size(), value);
    text.append(text.empty() ? "" : ",").append(digits.data(), end.ptr);
  }
  return text + "\n";
}

std::vector<ImuSample> read_imu_samples(const std::filesystem::path& file) {
  LineReader lines(file, "inertial measurements");
  std::vector<ImuSample> samples;
  std::string line;
  int previous = 0;
  while (lines.next(line)) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string::npos || line[begin] == '#') continue;
    const SourceLocation place = lines.location();
    if (samples.empty() && previous == 0 && names_columns(line, place)) {
      previous = lines.number();
      continue;
    }
    const ImuSample sample = parsed_sample(line, place);
    if (!samples.empty() && !(samples.back().timestamp < sample.timestamp))
      throw InputError(place, "found the time stamp " + stamp_text(sample.timestamp) + ", which is not later than " +
                                  stamp_text(samples.back().timestamp) + " in line " + std::to_string(previous) +
                                  "; expected stamps that rise from line to line; sort the lines by time, and take out "
                                  "those with the same stamp");
    samples.push_back(sample);
    previous = lines.number();
  }
  if (samples.empty())
    throw InputError({file.string()}, std::string("holds no inertial measurements; ") + expected_line);
  return samples;
}

std::filesystem::path find_imu_file(const std::filesystem::path& folder, const std::filesystem::path& name) {
  if (!name.empty()) return folder / name;  // an absolute name stays as it is
  std::filesystem::path file = folder / "imu.csv";
  if (!why_unreadable(file, largest_file::text).empty()) return {};
  LineReader lines(file, "inertial measurements");
  std::string first;
  const bool is_ours = lines.next(first) && first + '\n' == imu_header;
  return is_ours ? file : std::filesystem::path();
}

RecordedImu::RecordedImu(const std::filesystem::path& file, const std::optional<ImuCalibration>& calibration,
                         std::span<const double> frame_timestamps)
    : RecordedImu(file.empty() ? std::vector<ImuSample>() : read_imu_samples(file), file.string(), calibration,
                  frame_timestamps) {}

RecordedImu::RecordedImu(std::vector<ImuSample> samples, const std::string& place,
                         const std::optional<ImuCalibration>& calibration, std::span<const double> frame_timestamps)
    : calibration_(calibration), timeline_(std::move(samples), calibration ? calibration->time_offset : 0.0) {
  if (timeline_.empty()) return;
  ImuExpectation expected;
  if (calibration) expected = {calibration->rate, calibration->gyroscope_range, calibration->accelerometer_range};
  for (std::string& suspicion : imu_suspicions(timeline_.samples(), expected))
    warnings_.push_back({{place}, std::move(suspicion)});
  check_times(place, frame_timestamps);
}

void RecordedImu::check_times(const std::string& place, std::span<const double> frames) {
  if (frames.empty()) return;
  const double first = timeline_.samples().front().timestamp, last = timeline_.samples().back().timestamp;
  const std::string times = "the inertial measurements last from " + stamp_text(first) + " to " + stamp_text(last) +
                            ", the frames from " + stamp_text(frames.front()) + " to " + stamp_text(frames.back());
  if (last < frames.front() || first > frames.back())
    throw InputError({place}, times +
                                  "; expected the same time by the same clock; correct the time stamps, or "
                                  "set `time_offset` of `imu`");
  const auto is_covered = [&](double stamp) { return stamp >= first && stamp <= last; };
  const auto uncovered = std::count_if(frames.begin(), frames.end(), [&](double s) { return !is_covered(s); });
  if (uncovered > 0 && (frames.front() < first - 0.1 || frames.back() > last + 0.1))
    warnings_.push_back({{place},
                         times + ": " + std::to_string(uncovered) + " of " + std::to_string(frames.size()) +
                             " frames have none; record both together"});
}

void RecordedImu::describe(SourceDescription& description) const {
  if (timeline_.empty()) return;
  description.has_imu = true;
  description.imu = calibration_;
}

void RecordedImu::add_to(SensorFrame& frame) {
  if (!timeline_.empty()) frame.imu = timeline_.take(frame.timestamp);
}

}  // namespace holdfast
