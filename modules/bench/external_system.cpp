// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/external_system.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "holdfast/core/parsed_number.hpp"
#include "holdfast/core/text_file.hpp"
#include "holdfast/evaluation/number_text.hpp"

namespace holdfast {

namespace {

/// A real number as OpenCV's files want it: with a point, so that it is not taken for an integer.
std::string real_text(double value) {
  std::string text = shortest_text(value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

/// Calls visit(begin, end, name) for every {name} of lower-case letters.
template <class Visit>
void for_each_placeholder(const std::string& text, const Visit& visit) {
  for (std::size_t begin = text.find('{'); begin != std::string::npos; begin = text.find('{', begin + 1)) {
    const std::size_t end = text.find_first_not_of("abcdefghijklmnopqrstuvwxyz_", begin + 1);
    if (end == std::string::npos || text[end] != '}' || end == begin + 1) continue;
    visit(begin, end + 1, text.substr(begin + 1, end - begin - 1));
  }
}

enum class Line { blank, pose, not_finite, malformed };

Line read_line(std::string_view line, TimedPose& pose) {
  line = line.substr(0, line.find('#'));
  double numbers[8];
  std::size_t count = 0;
  while (count < 8) {
    const std::size_t begin = line.find_first_not_of(" \t\r,");
    if (begin == std::string_view::npos) break;
    line.remove_prefix(begin);
    const std::size_t end = std::min(line.find_first_of(" \t\r,"), line.size());
    const auto number = parsed_number<double>(line.substr(0, end));
    if (!number) return Line::malformed;
    numbers[count] = *number;
    line.remove_prefix(end);
    ++count;
  }
  if (count == 0) return Line::blank;
  if (count < 8) return Line::malformed;
  const Eigen::Quaterniond rotation(numbers[7], numbers[4], numbers[5], numbers[6]);
  const bool is_finite = std::all_of(numbers, numbers + 8, [](double value) { return std::isfinite(value); });
  if (!is_finite || rotation.norm() == 0.0) return Line::not_finite;
  if (std::abs(rotation.norm() - 1.0) > 0.02) return Line::malformed;  // as read_trajectory() says
  pose.timestamp = numbers[0];
  pose.T_world_camera = Eigen::Translation3d(numbers[1], numbers[2], numbers[3]) * rotation.normalized();
  return Line::pose;
}

}  // namespace

std::string associations_text(const RecordedSequence& sequence) {
  std::string text;
  for (const ListedPair& pair : sequence.frames)
    text += stamp_text(pair.colour.timestamp) + ' ' + pair.colour.name + ' ' + stamp_text(pair.depth.timestamp) + ' ' +
            pair.depth.name + '\n';
  return text;
}

std::string orb_slam2_settings(const RecordedSequence& sequence,
                               const std::vector<std::pair<std::string, std::string>>& changes) {
  const Camera& camera = sequence.camera;
  const Distortion& distortion = camera.distortion;
  std::vector<std::pair<std::string, std::string>> values = {
      {"Camera.fx", real_text(camera.fx)},
      {"Camera.fy", real_text(camera.fy)},
      {"Camera.cx", real_text(camera.cx)},
      {"Camera.cy", real_text(camera.cy)},
      {"Camera.k1", real_text(distortion.k1)},
      {"Camera.k2", real_text(distortion.k2)},
      {"Camera.p1", real_text(distortion.p1)},
      {"Camera.p2", real_text(distortion.p2)},
      {"Camera.k3", real_text(distortion.k3)},
      {"Camera.width", std::to_string(camera.width)},
      {"Camera.height", std::to_string(camera.height)},
      {"Camera.fps", real_text(camera.frame_rate)},
      {"Camera.bf", real_text(camera.fx * camera.baseline)},
      {"Camera.RGB", "1"},  // as in the files for TUM sequences, with which its figures were published
      {"ThDepth", "40.0"},
      {"DepthMapFactor", real_text(sequence.depth_factor)},
      {"ORBextractor.nFeatures", "1000"},
      {"ORBextractor.scaleFactor", "1.2"},
      {"ORBextractor.nLevels", "8"},
      {"ORBextractor.iniThFAST", "20"},
      {"ORBextractor.minThFAST", "7"},
      {"Viewer.KeyFrameSize", "0.05"},
      {"Viewer.KeyFrameLineWidth", "1"},
      {"Viewer.GraphLineWidth", "0.9"},
      {"Viewer.PointSize", "2"},
      {"Viewer.CameraSize", "0.08"},
      {"Viewer.CameraLineWidth", "3"},
      {"Viewer.ViewpointX", "0"},
      {"Viewer.ViewpointY", "-0.7"},
      {"Viewer.ViewpointZ", "-1.8"},
      {"Viewer.ViewpointF", "500"},
  };
  for (const auto& change : changes) {
    const auto same =
        std::find_if(values.begin(), values.end(), [&](const auto& v) { return v.first == change.first; });
    if (same != values.end())
      same->second = change.second;
    else
      values.push_back(change);
  }
  std::string text = "%YAML:1.0\n---\n";
  for (const auto& [name, value] : values) text += name + ": " + value + "\n";
  return text;
}

const std::vector<std::string>& placeholder_names() {
  static const std::vector<std::string> names = {"sequence", "name", "associations", "settings", "output"};
  return names;
}

std::optional<std::string> unknown_placeholder(const std::string& text) {
  std::optional<std::string> unknown;
  const std::vector<std::string>& known = placeholder_names();
  for_each_placeholder(text, [&](std::size_t, std::size_t, const std::string& name) {
    if (!unknown && std::find(known.begin(), known.end(), name) == known.end()) unknown = name;
  });
  return unknown;
}

std::string fill_placeholders(const std::string& text, const Placeholders& values) {
  std::string filled;
  std::size_t done = 0;
  for_each_placeholder(text, [&](std::size_t begin, std::size_t end, const std::string& name) {
    const auto value = values.find(name);
    if (value == values.end()) return;
    filled += text.substr(done, begin - done) + value->second;
    done = end;
  });
  return filled + text.substr(done);
}

SalvagedTrajectory salvage_trajectory(const std::filesystem::path& file) {
  SalvagedTrajectory result;
  std::error_code ignored;
  result.exists = std::filesystem::is_regular_file(file, ignored);
  if (!result.exists) return result;
  LineReader lines(file, "a trajectory");
  TimedPose pose;
  for (std::string line; lines.next(line);) {
    switch (read_line(line, pose)) {
      case Line::blank:
        break;
      case Line::pose:
        result.poses.push_back(pose);
        break;
      case Line::not_finite:
        ++result.not_finite;
        break;
      case Line::malformed:
        ++result.malformed;
        break;
    }
  }
  result.poses = sort_and_clean(std::move(result.poses));
  return result;
}

}  // namespace holdfast
