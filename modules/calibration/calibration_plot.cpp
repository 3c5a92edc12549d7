// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "holdfast/calibration/calibration_output.hpp"
#include "holdfast/evaluation/number_text.hpp"

namespace holdfast {

namespace {

const cv::Scalar background(255, 255, 255), ink(60, 50, 45), faint(225, 220, 216), shade(250, 240, 226),
    bar(190, 120, 40), left_out(70, 70, 200);

constexpr int map_width = 880;
constexpr int gap = 50;
constexpr int side = 420;

void write(cv::Mat& picture, const std::string& text, cv::Point place, double size = 0.5,
           const cv::Scalar& colour = ink) {
  cv::putText(picture, text, place, cv::FONT_HERSHEY_SIMPLEX, size, colour, 1, cv::LINE_AA);
}

/// From blue through green and yellow to red.
cv::Scalar error_colour(double share) {
  const cv::Vec3d stops[] = {{180, 110, 30}, {90, 160, 40}, {20, 180, 230}, {50, 50, 215}};
  const double at = 3.0 * std::clamp(share, 0.0, 1.0);
  const int below = std::min(2, static_cast<int>(at));
  const cv::Vec3d mixed = stops[below] * (1.0 - (at - below)) + stops[below + 1] * (at - below);
  return {mixed[0], mixed[1], mixed[2]};
}

/// A round number at least as large: 1, 2 or 5 times a power of ten.
double rounded_up(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(std::max(1e-6, value))));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= value) return factor * power;
  return 10.0 * power;
}

/// The length that 95 of 100 residuals of used views do not exceed.
double usual_error(const Calibration& calibration) {
  std::vector<double> lengths;
  for (const CalibratedView& view : calibration.views)
    for (const Eigen::Vector2d& residual : view.residuals)
      if (view.is_used) lengths.push_back(residual.norm());
  if (lengths.empty()) return 1.0;
  std::sort(lengths.begin(), lengths.end());
  return std::max(1e-3, lengths[(lengths.size() - 1) * 95 / 100]);
}

void draw_corners(const Calibration& calibration, const CalibrationAssessment& assessment, double usual,
                  const cv::Rect& place, cv::Mat& picture) {
  const Camera& camera = calibration.camera;
  const double scale = static_cast<double>(place.width) / camera.width;
  for (int row = 0; row < CalibrationAssessment::cell_rows; ++row) {
    for (int column = 0; column < CalibrationAssessment::cell_columns; ++column) {
      const auto edge = [&](int at, int count, int size) { return at * size / count; };
      const cv::Point low(place.x + edge(column, CalibrationAssessment::cell_columns, place.width),
                          place.y + edge(row, CalibrationAssessment::cell_rows, place.height));
      const cv::Point high(place.x + edge(column + 1, CalibrationAssessment::cell_columns, place.width),
                           place.y + edge(row + 1, CalibrationAssessment::cell_rows, place.height));
      const bool is_filled =
          assessment.cells[static_cast<std::size_t>(row * CalibrationAssessment::cell_columns + column)] > 0;
      if (is_filled) cv::rectangle(picture, low, high, shade, cv::FILLED);
      cv::rectangle(picture, low, high, faint);
    }
  }
  cv::rectangle(picture, place, ink);
  const double enlarged = 25.0 / usual;  // a usual difference is drawn 25 pixels long
  for (const CalibratedView& view : calibration.views) {
    if (!view.is_used) continue;
    for (std::size_t i = 0; i < view.residuals.size(); ++i) {
      const Eigen::Vector2d from = view.view.pixels[i] * scale, to = from + view.residuals[i] * enlarged;
      const cv::Point2d corner(place.x + from.x(), place.y + from.y()), end(place.x + to.x(), place.y + to.y());
      const cv::Scalar colour = error_colour(view.residuals[i].norm() / usual);
      cv::line(picture, corner, end, colour, 1, cv::LINE_AA);
      cv::circle(picture, corner, 2, colour, cv::FILLED, cv::LINE_AA);
    }
  }
  write(picture,
        "Corners and their differences, " + fixed_text(enlarged / scale, 0) +
            " times enlarged; shaded: cells with corners, " + fixed_text(100.0 * assessment.coverage, 0) +
            " % of the image",
        place.tl() - cv::Point(0, 12));
}

void draw_scatter(const Calibration& calibration, double usual, const cv::Rect& place, cv::Mat& picture) {
  const double reach = rounded_up(1.5 * usual), scale = 0.5 * place.width / reach;
  const cv::Point middle(place.x + place.width / 2, place.y + place.height / 2);
  cv::line(picture, {place.x, middle.y}, {place.br().x, middle.y}, faint);
  cv::line(picture, {middle.x, place.y}, {middle.x, place.br().y}, faint);
  for (const double share : {0.5, 1.0})
    cv::circle(picture, middle, static_cast<int>(share * reach * scale), faint, 1, cv::LINE_AA);
  for (const CalibratedView& view : calibration.views) {
    if (!view.is_used) continue;
    for (const Eigen::Vector2d& residual : view.residuals) {
      const cv::Point2d point(middle.x + residual.x() * scale, middle.y + residual.y() * scale);
      if (place.contains(point))
        cv::circle(picture, point, 2, error_colour(residual.norm() / usual), cv::FILLED, cv::LINE_AA);
    }
  }
  cv::rectangle(picture, place, ink);
  write(picture, "Differences; outer circle " + shortest_text(reach) + " px", place.tl() - cv::Point(0, 12));
}

void draw_views(const Calibration& calibration, const cv::Rect& place, cv::Mat& picture) {
  std::vector<double> errors;
  double largest = 1e-6;
  for (const CalibratedView& view : calibration.views)
    if (std::isfinite(view.rms) && view.is_used) largest = std::max(largest, view.rms);
  const double top = rounded_up(largest),
               width = static_cast<double>(place.width) / static_cast<double>(calibration.views.size());
  for (std::size_t i = 0; i < calibration.views.size(); ++i) {
    const CalibratedView& view = calibration.views[i];
    const double height = std::min(1.0, view.rms / top) * place.height;
    const cv::Point low(place.x + static_cast<int>((static_cast<double>(i) + 0.15) * width),
                        place.br().y - static_cast<int>(height));
    const cv::Point high(place.x + std::max(1, static_cast<int>((static_cast<double>(i) + 0.85) * width)),
                         place.br().y);
    cv::rectangle(picture, low, high, view.is_used ? bar : left_out, cv::FILLED);
  }
  const int mean = place.br().y - static_cast<int>(std::min(1.0, calibration.rms / top) * place.height);
  cv::line(picture, {place.x, mean}, {place.br().x, mean}, ink, 1, cv::LINE_AA);
  cv::rectangle(picture, place, ink);
  write(picture, shortest_text(top), {place.x - 42, place.y + 12}, 0.45);
  write(picture, "0", {place.x - 18, place.br().y}, 0.45);
  write(picture, "Error of each view [px]; line: of all, " + fixed_text(calibration.rms, 3) + "; red: left out",
        place.tl() - cv::Point(0, 12));
}

}  // namespace

cv::Mat calibration_plot(const Calibration& calibration, const CalibrationAssessment& assessment) {
  const Camera& camera = calibration.camera;
  const int map_height =
      std::max(1, static_cast<int>(std::lround(static_cast<double>(map_width) * camera.height / camera.width)));
  constexpr int bars = 150;
  const int upper = std::max(map_height, side);
  cv::Mat picture(upper + bars + 3 * gap, map_width + side + 3 * gap, CV_8UC3, background);
  const double usual = usual_error(calibration);
  draw_corners(calibration, assessment, usual, {gap, gap, map_width, map_height}, picture);
  draw_scatter(calibration, usual, {2 * gap + map_width, gap, side, side}, picture);
  draw_views(calibration, {gap, upper + 2 * gap, map_width + side + gap, bars}, picture);
  return picture;
}

}  // namespace holdfast
