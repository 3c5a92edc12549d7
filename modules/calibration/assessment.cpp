// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/calibration/assessment.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "holdfast/evaluation/number_text.hpp"

namespace holdfast {

namespace {

constexpr double degree = 3.14159265358979323846 / 180.0;

std::string joined(const std::vector<std::string>& names, std::size_t max_count) {
  std::string text;
  for (std::size_t i = 0; i < std::min(max_count, names.size()); ++i) text += (i == 0 ? "" : ", ") + names[i];
  return names.size() > max_count ? text + " and " + std::to_string(names.size() - max_count) + " more" : text;
}

std::string degrees(double angle) { return fixed_text(angle / degree, 0) + " degrees"; }

/// The ninths of the image of which more than half of the cells have no corner.
std::vector<std::string> empty_regions(const std::vector<int>& cells) {
  static const char* const names[3][3] = {{"upper left corner", "upper edge", "upper right corner"},
                                          {"left edge", "middle", "right edge"},
                                          {"lower left corner", "lower edge", "lower right corner"}};
  std::array<int, 9> all{}, empty{};
  for (int row = 0; row < CalibrationAssessment::cell_rows; ++row) {
    for (int column = 0; column < CalibrationAssessment::cell_columns; ++column) {
      const auto region = static_cast<std::size_t>(3 * (3 * row / CalibrationAssessment::cell_rows) +
                                                   3 * column / CalibrationAssessment::cell_columns);
      ++all[region];
      empty[region] += cells[static_cast<std::size_t>(row * CalibrationAssessment::cell_columns + column)] == 0;
    }
  }
  std::vector<std::string> result;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (2 * empty[i] > all[i]) result.emplace_back(names[i / 3][i % 3]);
  return result;
}

void count_corners(const Calibration& calibration, CalibrationAssessment& result) {
  constexpr int columns = CalibrationAssessment::cell_columns, rows = CalibrationAssessment::cell_rows;
  const Camera& camera = calibration.camera;
  const Eigen::Vector2d middle(0.5 * (camera.width - 1), 0.5 * (camera.height - 1));
  result.cells.assign(static_cast<std::size_t>(columns * rows), 0);
  for (const CalibratedView& view : calibration.views) {
    if (!view.is_used) continue;
    result.largest_tilt = std::max(result.largest_tilt, view.tilt);
    for (const Eigen::Vector2d& pixel : view.view.pixels) {
      const int column = std::clamp(static_cast<int>(pixel.x() * columns / camera.width), 0, columns - 1);
      const int row = std::clamp(static_cast<int>(pixel.y() * rows / camera.height), 0, rows - 1);
      ++result.cells[static_cast<std::size_t>(row * columns + column)];
      result.reach = std::max(result.reach, (pixel - middle).norm() / middle.norm());
    }
  }
  const auto filled = std::count_if(result.cells.begin(), result.cells.end(), [](int count) { return count > 0; });
  result.coverage = static_cast<double>(filled) / static_cast<double>(columns * rows);
}

/// Views from whose tilt the focal length can be told, by the axis around which the board is turned.
struct Tilts {
  int vertical = 0, horizontal = 0;
};

Tilts count_tilts(const Calibration& calibration) {
  Tilts tilts;
  for (const CalibratedView& view : calibration.views) {
    if (!view.is_used || view.tilt < 15.0 * degree) continue;
    const Eigen::Vector3d normal = view.T_camera_board.linear().col(2);
    ++(std::abs(normal.x()) > std::abs(normal.y()) ? tilts.vertical : tilts.horizontal);
  }
  return tilts;
}

std::string find_trouble(const Calibration& calibration, const CalibrationAssessment& result) {
  std::vector<std::string> names;
  for (const CalibratedView& view : calibration.views)
    if (view.is_used) names.push_back(view.view.name);
  const std::string remedy = "; photograph the board turned by 20 to 45 degrees to each side, up and down";
  if (result.largest_tilt < 8.0 * degree)
    return "every view shows the board from the front, tilted by at most " + degrees(result.largest_tilt) + " (" +
           joined(names, 8) + "), so that the focal length cannot be told from the distance" + remedy;
  const CalibratedNumber &fx = calibration.number("fx"), &fy = calibration.number("fy");
  const double uncertainty = std::max(fx.standard_deviation / fx.value, fy.standard_deviation / fy.value);
  if (!(uncertainty < 0.02))
    return "the focal length is uncertain by " +
           (std::isfinite(uncertainty) ? fixed_text(100.0 * uncertainty, 1) + " %" : std::string("any amount")) +
           "; expected less than 2 %" + remedy + ", also near the edges of the image";
  if (const std::string trouble = calibration.camera.trouble(); !trouble.empty())
    return trouble + "; photograph the board in the corners of the image as well, or estimate fewer coefficients";
  return "";
}

void advise(const Calibration& calibration, CalibrationAssessment& result) {
  std::vector<std::string>& advice = result.advice;
  if (const std::vector<std::string> empty = empty_regions(result.cells); !empty.empty())
    advice.push_back("bring the board into parts of the image without corners: " + joined(empty, 9));
  const Tilts tilts = count_tilts(calibration);
  if (tilts.vertical < 2) advice.emplace_back("turn the board to the left and to the right, by 20 to 45 degrees");
  if (tilts.horizontal < 2) advice.emplace_back("lean the board forwards and backwards, by 20 to 45 degrees");
  constexpr std::size_t enough_views = 10;
  if (calibration.used_count() < enough_views)
    advice.push_back("take " + std::to_string(enough_views - calibration.used_count()) +
                     " more pictures or more: ten views average out what a single one gets wrong");
  if (calibration.rms > 0.5)
    advice.push_back("the error of " + fixed_text(calibration.rms, 2) +
                     " px is large; expected less than 0.5: is the board flat, are the pictures sharp, was the "
                     "camera held still, is the lens of another kind?");
  std::vector<std::string> out;
  for (const CalibratedView& view : calibration.views)
    if (!view.is_used) out.push_back(view.view.name);
  if (!out.empty())
    advice.push_back("look at the views that disagree and were left out (" + joined(out, 8) +
                     "): blurred, a bent board, or wrong corners");
}

}  // namespace

CalibrationAssessment assess(const Calibration& calibration) {
  CalibrationAssessment result;
  count_corners(calibration, result);
  result.trouble = find_trouble(calibration, result);
  advise(calibration, result);
  return result;
}

}  // namespace holdfast
