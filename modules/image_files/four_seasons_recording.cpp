// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <string_view>

#include "holdfast/core/error.hpp"
#include "holdfast/core/parsed_number.hpp"
#include "holdfast/core/text_file.hpp"
#include "holdfast/image_files/calibrated_recording.hpp"

namespace holdfast {

namespace {

namespace fs = std::filesystem;

constexpr const char* separators = " \t\r,";

std::vector<std::string_view> separated_words(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t begin = line.find_first_not_of(separators); begin != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(separators, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(separators, end);
  }
  return words;
}

/// Calls use(place, words) for each line that is neither blank nor a comment.
template <class Use>
void read_rows(const fs::path& file, const std::string& form, Use&& use) {
  LineReader lines(file, form);
  std::string line;
  while (lines.next(line)) {
    const std::vector<std::string_view> words = separated_words(line);
    if (!words.empty() && words.front().front() != '#') use(lines.location(), words);
  }
}

/// Finite numbers of the words from `first`.
std::vector<double> finite_numbers(const SourceLocation& place, const std::vector<std::string_view>& words,
                                   std::size_t first, const std::string& form) {
  std::vector<double> numbers;
  for (std::size_t i = first; i < words.size(); ++i) {
    const auto number = parsed_number<double>(words[i]);
    if (!number || !std::isfinite(*number))
      throw InputError(place, "found '" + std::string(words[i]) + "'; expected " + form);
    numbers.push_back(*number);
  }
  return numbers;
}

fs::path four_seasons_calibration(const FourSeasonsOptions& options) {
  if (!options.calibration.empty()) return options.calibration;
  std::error_code error;
  const fs::path sequence = fs::weakly_canonical(options.path, error);
  for (const fs::path& place : {sequence, sequence.parent_path()})
    for (const char* name : {"calibration", "Calibration"})
      if (fs::is_directory(place / name, error)) return place / name;
  throw InputError({(sequence.parent_path() / "calibration").string()},
                   "is missing; expected the calibration of the cameras, an archive of its own of the 4Seasons data, "
                   "unpacked beside the sequence or in it; or set `source.four_seasons.calibration`");
}

/// Reads an undistorted_calib_N.txt: "Pinhole fx fy cx cy 0", width and height, and lines that are not needed.
Camera read_pinhole(const fs::path& file) {
  const std::string form = "'Pinhole fx fy cx cy 0' and, in the second line, width and height";
  Camera camera;
  int line = 0;
  read_rows(file, form, [&](const SourceLocation& place, const std::vector<std::string_view>& words) {
    ++line;
    if (line == 1) {
      if (words.front() != "Pinhole")
        throw InputError(place, "found the camera model '" + std::string(words.front()) + "'; expected " + form);
      const std::vector<double> n = finite_numbers(place, words, 1, form);
      const bool is_usable = n.size() >= 4 && n[0] > 0.0 && n[1] > 0.0 &&
                             std::all_of(n.begin() + 4, n.end(), [](double k) { return k == 0.0; });
      if (!is_usable)
        throw InputError(place, "does not have the intrinsics of an undistorted camera; expected " + form);
      camera.fx = n[0], camera.fy = n[1], camera.cx = n[2], camera.cy = n[3];
    } else if (line == 2) {
      const auto width = words.size() == 2 ? parsed_number<int>(words[0]) : std::nullopt;
      const auto height = words.size() == 2 ? parsed_number<int>(words[1]) : std::nullopt;
      if (!width || !height || *width < 1 || *height < 1 || std::max(*width, *height) > 32768)
        throw InputError(place, "does not have the size of an image; expected " + form);
      camera.width = *width, camera.height = *height;
    }
  });
  if (line < 2) throw InputError({file.string()}, "ends too early; expected " + form);
  return camera;
}

/// Baseline of a rectified pair from a 4x4 transform between its cameras, in either direction.
double read_baseline(const fs::path& file) {
  const std::string form = "the 16 numbers of the transform between the cameras of a rectified pair";
  std::vector<double> n;
  read_rows(file, form, [&](const SourceLocation& place, const std::vector<std::string_view>& words) {
    for (const double number : finite_numbers(place, words, 0, form)) n.push_back(number);
  });
  if (n.size() != 16)
    throw InputError({file.string()}, "has " + std::to_string(n.size()) + " numbers; expected " + form);
  const Eigen::Matrix4d T = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(n.data());
  const double baseline = std::abs(T(0, 3));
  constexpr double tolerance = 1e-3;
  const bool is_rectified = baseline > 0.0 && T.topLeftCorner<3, 3>().isIdentity(tolerance) &&
                            T.block<2, 1>(1, 3).cwiseAbs().maxCoeff() <= 0.01 * baseline;
  if (!is_rectified)
    throw InputError({file.string()},
                     "is not the transform of a rectified pair; expected no rotation, and a translation along x");
  return baseline;
}

Camera read_four_seasons_camera(const FourSeasonsOptions& options, bool is_pair) {
  const fs::path folder = four_seasons_calibration(options);
  Camera camera = read_pinhole(folder / "undistorted_calib_0.txt");
  if (!is_pair) return camera;
  const fs::path right_file = folder / "undistorted_calib_1.txt";
  const Camera right = read_pinhole(right_file);
  const auto differ = [](double a, double b) { return std::abs(a - b) > 1e-3; };
  if (differ(camera.fx, right.fx) || differ(camera.fy, right.fy) || differ(camera.cx, right.cx) ||
      differ(camera.cy, right.cy) || camera.width != right.width || camera.height != right.height)
    throw InputError({right_file.string()},
                     "has other values than undistorted_calib_0.txt; expected the equal cameras of a rectified pair");
  camera.baseline = read_baseline(folder / "undistorted_calib_stereo.txt");
  return camera;
}

/// A line of times.txt.
struct TimedFrame {
  std::string id;
  double timestamp = 0.0;
};

std::vector<TimedFrame> read_times(const fs::path& file) {
  const std::string form = "lines 'frame_id timestamp exposure'";
  std::vector<TimedFrame> frames;
  read_rows(file, form, [&](const SourceLocation& place, const std::vector<std::string_view>& words) {
    const auto stamp = words.size() >= 2 ? parsed_number<double>(words[1]) : std::nullopt;
    if (!parsed_number<std::int64_t>(words.front()) || !stamp || !std::isfinite(*stamp))
      throw InputError(place, "does not begin with a number and a time stamp; expected " + form);
    if (!frames.empty() && !(frames.back().timestamp < *stamp))
      throw InputError(place,
                       "has a time stamp that is not later than the one before; expected stamps that rise from "
                       "line to line");
    frames.push_back({std::string(words.front()), *stamp});
  });
  if (frames.empty()) throw InputError({file.string()}, "is an empty list; expected " + form);
  return frames;
}

/// The poses of keyframes, whose translations are scaled to metres. The rigid transform of the visual to the geographic
/// world is left out.
Trajectory read_keyframe_poses(const fs::path& file, const std::vector<TimedFrame>& frames) {
  const std::string form = "lines 'frame_id, x, y, z, qx, qy, qz, qw, scale, ...'";
  std::map<std::string, double, std::less<>> stamps;
  for (const TimedFrame& frame : frames) stamps[frame.id] = frame.timestamp;
  Trajectory truth;
  read_rows(file, form, [&](const SourceLocation& place, const std::vector<std::string_view>& words) {
    const std::vector<double> n = finite_numbers(place, words, 1, form);
    if (n.size() < 8) throw InputError(place, "has " + std::to_string(words.size()) + " values; expected " + form);
    const Eigen::Quaterniond rotation(n[6], n[3], n[4], n[5]);
    constexpr double tolerance = 0.02;
    if (std::abs(rotation.norm() - 1.0) > tolerance || !(n[7] > 0.0))
      throw InputError(place, "does not have a unit quaternion and a positive scale; expected " + form);
    if (const auto stamp = stamps.find(words.front()); stamp != stamps.end())
      truth.push_back(
          {stamp->second, Eigen::Translation3d(n[7] * n[0], n[7] * n[1], n[7] * n[2]) * rotation.normalized()});
  });
  if (truth.empty())
    throw InputError({file.string()},
                     "has no pose of a frame that times.txt lists; expected those of keyframes; is "
                     "it the file of another sequence?");
  return sort_and_clean(std::move(truth));
}

}  // namespace

CalibratedRecording read_four_seasons_recording(const FourSeasonsOptions& options) {
  require_recording_folder(options.path, "the folder of a sequence of 4Seasons, with times.txt",
                           "source.four_seasons.path");
  const fs::path left = options.path / "undistorted_images" / "cam0", right = left.parent_path() / "cam1";
  std::error_code error;
  if (!fs::is_directory(left, error))
    throw InputError({left.string()},
                     "is missing; expected the undistorted images of the left camera, named by the frame_id of "
                     "times.txt; unpack the archive of the undistorted stereo images");
  CalibratedRecording recording;
  recording.has_right = options.cameras == "pair" || (options.cameras == "auto" && fs::is_directory(right, error));
  recording.camera = read_four_seasons_camera(options, recording.has_right);
  recording.left_size = recording.right_size = {recording.camera.width, recording.camera.height};
  const fs::path list = options.path / "times.txt";
  const std::vector<TimedFrame> frames = read_times(list);
  for (const TimedFrame& frame : frames) {
    ImageFiles& files = recording.files.emplace_back();
    files.timestamp = frame.timestamp;
    files.colour = left / (frame.id + ".png");
    if (recording.has_right) files.right = right / (frame.id + ".png");
  }
  if (const fs::path truth = options.path / "GNSSPoses.txt"; fs::exists(truth, error))
    recording.truth = read_keyframe_poses(truth, frames);
  if (const fs::path samples = options.path / "imu.txt"; options.imu && fs::exists(samples, error)) {
    recording.imu_file = samples;
    recording.imu = options.imu;
  }
  measure_frame_rate(recording);
  select_range(recording.files, options.range.start, options.range.frames, options.path, "frames");
  return recording;
}

}  // namespace holdfast
