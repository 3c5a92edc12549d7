// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/kitti_raw_files.hpp"

#include <chrono>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <string>

#include "holdfast/core/error.hpp"
#include "holdfast/core/nearest_rotation.hpp"
#include "holdfast/core/parsed_number.hpp"
#include "holdfast/core/text_file.hpp"

namespace holdfast {

namespace {

constexpr const char* raw_blanks = " \t\r";

/// The numbers of a text; nothing if a word is not a finite number.
std::optional<std::vector<double>> parse_finite_row(std::string_view text) {
  std::vector<double> row;
  for (std::size_t begin = text.find_first_not_of(raw_blanks); begin != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(raw_blanks, begin), text.size());
    const auto number = parsed_number<double>(text.substr(begin, end - begin));
    if (!number || !std::isfinite(*number)) return std::nullopt;
    row.push_back(*number);
    begin = text.find_first_not_of(raw_blanks, end);
  }
  return row;
}

/// A calibration file: lines "KEY: numbers"; values that are not numbers (calib_time, corner_dist) are left out.
class KeyedNumbers {
 public:
  explicit KeyedNumbers(const std::filesystem::path& file) : file_(file) {
    LineReader lines(file, "lines 'KEY: numbers' of a calibration of the KITTI raw data");
    std::string line;
    while (lines.next(line)) {
      const std::size_t colon = line.find(':');
      if (colon == std::string::npos) continue;
      if (auto row = parse_finite_row(std::string_view(line).substr(colon + 1)))
        rows_[line.substr(0, colon)] = {lines.location(), *std::move(row)};
    }
  }

  /// The matrix of a key that must be there.
  template <int Rows, int Columns>
  Eigen::Matrix<double, Rows, Columns> matrix(const std::string& key) const {
    const auto found = rows_.find(key);
    if (found == rows_.end())
      throw InputError({file_.string()}, "lacks " + key + "; expected a calibration of the KITTI raw data");
    const auto& [place, row] = found->second;
    if (row.size() != Rows * Columns)
      throw InputError(place, "has " + std::to_string(row.size()) + " numbers; expected the " +
                                  std::to_string(Rows * Columns) + " of " + key);
    Eigen::Matrix<double, Rows, Columns> matrix;
    for (int i = 0; i < Rows * Columns; ++i) matrix(i / Columns, i % Columns) = row[static_cast<std::size_t>(i)];
    return matrix;
  }

  Eigen::Matrix3d rotation(const std::string& key) const {
    const Eigen::Matrix3d stored = matrix<3, 3>(key);
    constexpr double tolerance = 1e-3;
    if ((stored * stored.transpose() - Eigen::Matrix3d::Identity()).norm() > tolerance || stored.determinant() < 0.0)
      throw InputError(place_of(key), "is not a rotation; expected the 3x3 matrix of one, row by row");
    return nearest_rotation(stored);
  }

  SourceLocation place_of(const std::string& key) const { return rows_.at(key).first; }

 private:
  std::filesystem::path file_;
  std::map<std::string, std::pair<SourceLocation, std::vector<double>>> rows_;
};

/// "2011-09-26 13:02:25.964389445" as seconds since 1970.
std::optional<double> parse_stamp(std::string_view text) {
  text = text.substr(0, text.find_last_not_of(raw_blanks) + 1);
  constexpr std::string_view form = "0000-00-00 00:00:00";
  if (text.size() < form.size()) return std::nullopt;
  for (std::size_t i = 0; i < form.size(); ++i) {
    const bool is_digit = text[i] >= '0' && text[i] <= '9';
    if (form[i] == '0' ? !is_digit : text[i] != form[i]) return std::nullopt;
  }
  const auto number = [&](std::size_t begin, std::size_t count) {
    return *parsed_number<int>(text.substr(begin, count));
  };
  const auto seconds = parsed_number<double>(text.substr(17));
  const std::chrono::year_month_day date{std::chrono::year(number(0, 4)),
                                         std::chrono::month(static_cast<unsigned>(number(5, 2))),
                                         std::chrono::day(static_cast<unsigned>(number(8, 2)))};
  if (!date.ok() || !seconds || !(*seconds < 61.0) || number(11, 2) > 23 || number(14, 2) > 59) return std::nullopt;
  const auto days = std::chrono::sys_days(date).time_since_epoch().count();
  return 86400.0 * static_cast<double>(days) + 3600.0 * number(11, 2) + 60.0 * number(14, 2) + *seconds;
}

}  // namespace

KittiRawCalibration read_kitti_raw_calibration(const std::filesystem::path& file) {
  const KeyedNumbers numbers(file);
  KittiRawCalibration calibration;
  calibration.file = file;
  for (const std::string camera : {"00", "01", "02", "03"}) {
    const KittiProjection projection = numbers.matrix<3, 4>("P_rect_" + camera);
    require_rectified_projection(numbers.place_of("P_rect_" + camera), projection);
    calibration.projections.push_back(projection);
    const Eigen::Vector2d size = numbers.matrix<1, 2>("S_rect_" + camera);
    if (!(size.minCoeff() >= 1.0 && size.maxCoeff() <= 32768.0))
      throw InputError(numbers.place_of("S_rect_" + camera),
                       "is not the size of an image; expected its width and height");
    calibration.sizes.emplace_back(static_cast<int>(size.x()), static_cast<int>(size.y()));
  }
  calibration.rectification = numbers.rotation("R_rect_00");
  return calibration;
}

Eigen::Isometry3d read_kitti_transform(const std::filesystem::path& file) {
  const KeyedNumbers numbers(file);
  Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();
  transform.linear() = numbers.rotation("R");
  transform.translation() = numbers.matrix<3, 1>("T");
  return transform;
}

std::vector<double> read_kitti_stamps(const std::filesystem::path& file) {
  constexpr const char* form = "time stamps such as '2011-09-26 13:02:25.964389445', one a line";
  LineReader lines(file, form);
  std::vector<double> stamps;
  std::string line;
  while (lines.next(line)) {
    if (line.find_first_not_of(raw_blanks) == std::string::npos) continue;
    const auto stamp = parse_stamp(line);
    if (!stamp) throw InputError(lines.location(), "found '" + line.substr(0, 60) + "'; expected " + form);
    if (!stamps.empty() && !(stamps.back() < *stamp))
      throw InputError(lines.location(),
                       "has a time stamp that is not later than the one before; expected stamps that "
                       "rise from line to line");
    stamps.push_back(*stamp);
  }
  if (stamps.empty()) throw InputError({file.string()}, std::string("is empty; expected ") + form);
  return stamps;
}

KittiOxts read_kitti_oxts(const std::filesystem::path& file) {
  constexpr const char* form =
      "a line of numbers that begins with latitude, longitude [deg], altitude [m], roll, pitch and yaw [rad]";
  LineReader lines(file, form);
  std::string line;
  const auto row = lines.next(line) ? parse_finite_row(line) : std::nullopt;
  if (!row || row->size() < 6) throw InputError(lines.location(), std::string("is not a packet; expected ") + form);
  const std::vector<double>& n = *row;
  constexpr double largest_latitude = 89.0;
  if (!(std::abs(n[0]) <= largest_latitude))
    throw InputError(lines.location(), std::string("has a latitude that is none; expected ") + form);
  return {n[0], n[1], n[2], n[3], n[4], n[5]};
}

KittiMercator::KittiMercator(const KittiOxts& first) : scale_(std::cos(first.latitude * std::numbers::pi / 180.0)) {
  origin_ = project(first);
}

Eigen::Isometry3d KittiMercator::pose(const KittiOxts& packet) const {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = (Eigen::AngleAxisd(packet.yaw, Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(packet.pitch, Eigen::Vector3d::UnitY()) *
                   Eigen::AngleAxisd(packet.roll, Eigen::Vector3d::UnitX()))
                      .toRotationMatrix();
  pose.translation() = project(packet) - origin_;
  return pose;
}

Eigen::Vector3d KittiMercator::project(const KittiOxts& packet) const {
  constexpr double earth_radius = 6378137.0;  // m
  constexpr double radians = std::numbers::pi / 180.0;
  return {scale_ * earth_radius * packet.longitude * radians,
          scale_ * earth_radius * std::log(std::tan((90.0 + packet.latitude) * radians / 2.0)), packet.altitude};
}

}  // namespace holdfast
