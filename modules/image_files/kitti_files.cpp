// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/kitti_files.hpp"

#include <charconv>
#include <cmath>
#include <optional>
#include <string>

#include "holdfast/core/error.hpp"
#include "holdfast/core/nearest_rotation.hpp"
#include "holdfast/core/text_file.hpp"

namespace holdfast {

namespace {

constexpr const char* spaces = " \t\r";

/// One line with twelve numbers, after a name that may be empty.
struct NumberedLine {
  std::string name;  ///< "P0" of "P0: ..."
  KittiProjection matrix;
};

std::optional<NumberedLine> parse_line(const SourceLocation& place, std::string text, const char* content) {
  NumberedLine line;
  if (const std::size_t colon = text.find(':'); colon != std::string::npos) {
    line.name = text.substr(0, colon);
    text.erase(0, colon + 1);
  }
  int count = 0;
  std::size_t position = text.find_first_not_of(spaces);
  while (position != std::string::npos) {
    const std::size_t end = std::min(text.find_first_of(spaces, position), text.size());
    double value = 0.0;
    const auto [stop, error] = std::from_chars(text.data() + position, text.data() + end, value);
    if (error != std::errc() || stop != text.data() + end || !std::isfinite(value))
      throw InputError(place, "found '" + text.substr(position, end - position) + "'; expected a number of " + content);
    if (count < 12) line.matrix(count / 4, count % 4) = value;
    ++count;
    position = text.find_first_not_of(spaces, end);
  }
  if (count == 0 && line.name.empty()) return std::nullopt;
  if (count != 12) throw InputError(place, "has " + std::to_string(count) + " numbers; expected the 12 of " + content);
  return line;
}

/// Calls use(place, line) for every line that is not empty.
template <class Use>
void read_lines(const std::filesystem::path& file, const char* content, Use&& use) {
  LineReader lines(file, std::string("lines of ") + content);
  std::string text;
  while (lines.next(text)) {
    const SourceLocation place = lines.location();
    if (const auto line = parse_line(place, text, content)) use(place, *line);
  }
}

}  // namespace

void require_rectified_projection(const SourceLocation& place, const KittiProjection& p) {
  const bool is_rectified = p(0, 0) > 0.0 && p(1, 1) > 0.0 && p(0, 1) == 0.0 && p(1, 0) == 0.0 && p(2, 0) == 0.0 &&
                            p(2, 1) == 0.0 && p(2, 2) == 1.0;
  if (!is_rectified)
    throw InputError(place, "is not the projection of a rectified camera; expected fx 0 cx tx, 0 fy cy ty, 0 0 1 tz");
}

std::vector<KittiProjection> read_kitti_calibration(const std::filesystem::path& file, std::size_t least) {
  std::vector<KittiProjection> projections;
  read_lines(file, "a 3x4 projection matrix, row by row", [&](const SourceLocation& place, const NumberedLine& line) {
    if (!line.name.empty() && line.name.front() != 'P') return;  // Tr, the laser scanner's
    require_rectified_projection(place, line.matrix);
    projections.push_back(line.matrix);
  });
  if (projections.size() < least)
    throw InputError({file.string()}, "has " + std::to_string(projections.size()) +
                                          " projection matrices; expected one for each camera, left before right");
  return projections;
}

std::vector<Eigen::Isometry3d> read_kitti_poses(const std::filesystem::path& file) {
  std::vector<Eigen::Isometry3d> poses;
  read_lines(file, "a 3x4 pose, row by row", [&](const SourceLocation& place, const NumberedLine& line) {
    if (!line.name.empty()) throw InputError(place, "begins with '" + line.name + ":'; expected the 12 numbers only");
    const Eigen::Matrix3d stored = line.matrix.leftCols<3>();
    constexpr double tolerance = 1e-3;
    if ((stored * stored.transpose() - Eigen::Matrix3d::Identity()).norm() > tolerance || stored.determinant() < 0.0)
      throw InputError(place, "is not a pose: its left 3x3 part is not a rotation");
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = nearest_rotation(stored);
    pose.translation() = line.matrix.col(3);
    poses.push_back(pose);
  });
  return poses;
}

}  // namespace holdfast
