// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include "holdfast/core/counted.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/parsed_number.hpp"
#include "holdfast/core/text_file.hpp"
#include "phone_layouts.hpp"

namespace holdfast {

namespace {

namespace fs = std::filesystem;

/// The values of a line, between commas and without the blanks around them.
std::vector<std::string> values_of(std::string_view line) {
  std::vector<std::string> values;
  for (;;) {
    const std::size_t comma = line.find(',');
    std::string_view value = line.substr(0, comma);
    while (!value.empty() && (value.front() == ' ' || value.front() == '\t')) value.remove_prefix(1);
    while (!value.empty() && (value.back() == ' ' || value.back() == '\r' || value.back() == '\t'))
      value.remove_suffix(1);
    values.emplace_back(value);
    if (comma == std::string_view::npos) return values;
    line.remove_prefix(comma + 1);
  }
}

double finite(const SourceLocation& place, const std::string& text) {
  const auto number = parsed_number<double>(text);
  if (!number || !std::isfinite(*number)) throw InputError(place, "found '" + text + "'; expected a number");
  return *number;
}

FrameIntrinsics read_camera_matrix(const fs::path& file) {
  LineReader lines(file, "three lines of three numbers, the matrix of the camera");
  std::vector<double> k;
  for (std::string text; lines.next(text);)
    if (text.find_first_not_of(" \t\r") != std::string::npos)
      for (const std::string& value : values_of(text)) k.push_back(finite(lines.location(), value));
  const bool is_camera = k.size() == 9 && k[0] > 0.0 && k[4] > 0.0 && k[3] == 0.0 && k[6] == 0.0 && k[7] == 0.0;
  if (!is_camera)
    throw InputError({file.string()}, "is not the matrix of a camera; expected fx, 0, cx; 0, fy, cy; 0, 0, 1");
  return {k[0], k[4], k[2], k[5]};
}

/// Columns of odometry.csv by their names in its first line, because later versions of the app have more.
class OdometryTable {
 public:
  explicit OdometryTable(const fs::path& file)
      : lines_(file, "lines 'timestamp, frame, x, y, z, qx, qy, qz, qw' below these names") {
    std::string text;
    if (lines_.next(text)) names_ = values_of(text);
    for (const char* name : {"timestamp", "frame", "x", "y", "z", "qx", "qy", "qz", "qw"})
      if (!has(name))
        throw InputError({file.string(), 1}, std::string("has no column '") + name +
                                                 "'; expected 'timestamp, frame, x, y, z, qx, qy, qz, qw'; recordings "
                                                 "of the first versions of Stray Scanner have no time stamps");
  }
  bool has(const std::string& name) const { return std::find(names_.begin(), names_.end(), name) != names_.end(); }
  /// False at the end.
  bool next() {
    std::string text;
    do {
      if (!lines_.next(text)) return false;
    } while (text.find_first_not_of(" \t\r") == std::string::npos);
    values_ = values_of(text);
    if (values_.size() == names_.size()) return true;
    throw InputError(place(), "has " + counted(values_.size(), "value") + "; expected " +
                                  std::to_string(names_.size()) + ", as the first line has");
  }
  const std::string& text(const std::string& name) const {
    return values_[static_cast<std::size_t>(std::find(names_.begin(), names_.end(), name) - names_.begin())];
  }
  double number(const std::string& name) const { return finite(place(), text(name)); }
  SourceLocation place() const { return lines_.location(); }

 private:
  LineReader lines_;
  std::vector<std::string> names_, values_;
};

/// Fails for a line that is missing or there twice: the frames of the video have no numbers and are those of the lines
/// in their order, while depth images have the numbers of the column `frame`.
void require_next_frame(const OdometryTable& row, std::size_t index, double& first) {
  const double number = row.number("frame");
  if (index == 0) first = number;
  const double expected = first + static_cast<double>(index);
  if (number == expected) return;
  throw InputError(row.place(), "is of frame " + row.text("frame") + "; expected frame " +
                                    std::to_string(static_cast<std::int64_t>(expected)) +
                                    ", because each frame of the video has a line; export the recording again");
}

/// The pose of the camera, whose axes are right, down and forward already.
Eigen::Isometry3d read_pose(const OdometryTable& row) {
  const Eigen::Quaterniond rotation(row.number("qw"), row.number("qx"), row.number("qy"), row.number("qz"));
  constexpr double tolerance = 1e-2;
  if (std::abs(rotation.norm() - 1.0) > tolerance)
    throw InputError(row.place(), "is not a pose: its quaternion has the length " + std::to_string(rotation.norm()) +
                                      "; expected qx, qy, qz, qw of a rotation");
  Eigen::Isometry3d pose(rotation.normalized());
  pose.translation() = Eigen::Vector3d(row.number("x"), row.number("y"), row.number("z"));
  return pose;
}

}  // namespace

CalibratedRecording read_stray_scanner(const fs::path& folder, const PhoneOptions& options) {
  const fs::path list = folder / "odometry.csv";
  CalibratedRecording recording;
  recording.camera.name = "stray_scanner";
  recording.colour_is_video = true;
  std::error_code error;
  const bool has_depth = fs::is_directory(folder / "depth", error);
  const bool has_confidence = fs::is_directory(folder / "confidence", error);
  if (has_depth) recording.depth = DepthEncoding(options.depth_factor > 0.0 ? options.depth_factor : 1000.0);
  OdometryTable rows(list);
  std::vector<FrameIntrinsics> intrinsics;
  double first_frame = 0.0;
  while (rows.next()) {
    require_next_frame(rows, recording.files.size(), first_frame);
    ImageFiles files;
    files.timestamp = rows.number("timestamp");
    if (!recording.files.empty() && !(recording.files.back().timestamp < files.timestamp))
      throw InputError(rows.place(), "is not later than the line before; expected time stamps that increase");
    files.colour = folder / "rgb.mp4";
    files.video_index = recording.files.size();
    files.colour_listed_at = files.depth_listed_at = rows.place();
    if (has_depth) files.depth = folder / "depth" / (rows.text("frame") + ".png");
    if (has_depth && has_confidence) files.confidence = folder / "confidence" / (rows.text("frame") + ".png");
    if (rows.has("fx") && rows.has("fy") && rows.has("cx") && rows.has("cy"))
      intrinsics.push_back({rows.number("fx"), rows.number("fy"), rows.number("cx"), rows.number("cy")});
    recording.truth.push_back({files.timestamp, read_pose(rows)});
    recording.files.push_back(std::move(files));
  }
  if (recording.files.empty()) throw InputError({list.string()}, "lists no frame; expected a line for each");
  if (intrinsics.empty()) intrinsics.push_back(read_camera_matrix(folder / "camera_matrix.csv"));
  set_median_intrinsics(recording.camera, intrinsics);
  return recording;
}

}  // namespace holdfast
