// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/evaluation/coverage.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "holdfast/core/association.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/parsed_number.hpp"
#include "holdfast/core/text_file.hpp"

namespace holdfast {

namespace {

constexpr double frame_tolerance = 0.001;        // [s]
constexpr double colour_depth_tolerance = 0.02;  // [s]

std::vector<double> read_stamp_list(const std::filesystem::path& file) {
  LineReader lines(file, "a list of frames, each line beginning with a stamp");
  std::vector<double> stamps;
  std::string line;
  while (lines.next(line)) {
    const std::string_view content = std::string_view(line).substr(0, line.find('#'));
    const std::size_t begin = content.find_first_not_of(" \t\r,");
    if (begin == std::string_view::npos) continue;
    const std::size_t end = std::min(content.find_first_of(" \t\r,", begin), content.size());
    const auto stamp = parsed_number<double>(content.substr(begin, end - begin));
    if (!stamp || !std::isfinite(*stamp))
      throw InputError(lines.location(),
                       "found '" + line.substr(0, 60) + "'; expected a line that begins with a stamp in seconds");
    stamps.push_back(*stamp);
  }
  if (stamps.empty())
    throw InputError({file.string()}, "holds no frame; expected lines that begin with a stamp in seconds");
  std::sort(stamps.begin(), stamps.end());
  stamps.erase(std::unique(stamps.begin(), stamps.end()), stamps.end());
  return stamps;
}

}  // namespace

Coverage measure_coverage(std::span<const double> frame_stamps, std::span<const double> pose_stamps) {
  HOLDFAST_CHECK(!frame_stamps.empty(), "poses " << pose_stamps.size());
  Coverage coverage;
  const auto pairs = associate_stamps(frame_stamps, pose_stamps, frame_tolerance);
  coverage.frames = frame_stamps.size();
  coverage.poses = pairs.size();
  coverage.poses_of_no_frame = pose_stamps.size() - pairs.size();
  std::size_t next = 0;  // the first frame that is not accounted for yet
  const auto close_gap = [&](std::size_t frame_with_pose) {
    if (frame_with_pose == next) return;
    const std::size_t before = next == 0 ? 0 : next - 1;
    const std::size_t after = std::min(frame_with_pose, frame_stamps.size() - 1);
    coverage.gaps.push_back({frame_stamps[before], frame_stamps[after], frame_with_pose - next});
  };
  for (const auto& pair : pairs) {
    close_gap(pair.first);
    next = pair.first + 1;
  }
  close_gap(frame_stamps.size());
  return coverage;
}

std::vector<double> read_frame_stamps(const std::filesystem::path& source) {
  std::error_code status;
  if (!std::filesystem::exists(source, status))
    throw InputError({source.string()},
                     "no such file or folder; expected a list of frames or the folder of a TUM sequence");
  if (!std::filesystem::is_directory(source, status)) return read_stamp_list(source);
  const std::vector<double> colour = read_stamp_list(source / "rgb.txt");
  const std::vector<double> depth = read_stamp_list(source / "depth.txt");
  std::vector<double> stamps;
  for (const auto& pair : associate_stamps(colour, depth, colour_depth_tolerance)) stamps.push_back(colour[pair.first]);
  if (stamps.empty())
    throw InputError({source.string()}, "no colour frame of rgb.txt has a depth frame of depth.txt within 0.02 s");
  return stamps;
}

}  // namespace holdfast
