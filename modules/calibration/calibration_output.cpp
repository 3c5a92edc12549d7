// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/calibration/calibration_output.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "holdfast/core/size_text.hpp"
#include "holdfast/evaluation/number_text.hpp"

namespace holdfast {

namespace {

constexpr double degrees_of_radian = 57.29577951308232;

/// Pixels need fewer digits than coefficients.
int decimals_of(const std::string& name) { return name.front() == 'k' || name.front() == 'p' ? 9 : 4; }

std::string text_of(const CalibratedNumber& number) { return fixed_text(number.value, decimals_of(number.name)); }

std::string padded(const std::string& text, std::size_t width) {
  return std::string(width - std::min(width, text.size()), ' ') + text;
}

std::string deviation_text(const CalibratedNumber& number) {
  if (!std::isfinite(number.standard_deviation)) return "not determined";
  return fixed_text(number.standard_deviation, decimals_of(number.name));
}

/// JSON has no number for what is not finite.
nlohmann::json finite(double value) { return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(); }

std::string size_text(const CalibrationBoard& board) {
  return std::to_string(board.columns) + "x" + std::to_string(board.rows);
}

}  // namespace

std::string camera_yaml(const Calibration& calibration, const CalibrationBoard& board) {
  const Camera& camera = calibration.camera;
  std::string yaml = "# Calibrated by " + counted(calibration.used_count(), "view") + " of a " +
                     board_pattern_name(board.pattern) + " of " + size_text(board) + " corners, " +
                     shortest_text(board.square) + " m apart; reprojection error " + fixed_text(calibration.rms, 3) +
                     " px.\ncamera:\n  width: " + std::to_string(camera.width) +
                     "\n  height: " + std::to_string(camera.height) + "\n";
  for (const CalibratedNumber& number : calibration.numbers) {
    if (number.name == "k1") yaml += std::string("  lens: ") + lens_name(camera.distortion.lens) + "\n";
    yaml += "  " + number.name + ": " + text_of(number) + "\n";
  }
  return yaml;
}

std::string to_text(const Calibration& calibration, const CalibrationAssessment& assessment) {
  const Camera& camera = calibration.camera;
  std::string text = counted(calibration.views.size(), "view") + ", " + std::to_string(calibration.used_count()) +
                     " used; images " + size_text(camera.width, camera.height) + ", lens " +
                     lens_name(camera.distortion.lens) + "\nreprojection error " + fixed_text(calibration.rms, 3) +
                     " px RMS\n\n";
  for (const CalibratedNumber& number : calibration.numbers)
    text += "  " + number.name + padded(text_of(number), 16) + "  +- " + deviation_text(number) + "\n";
  text += "\ncorners in " + fixed_text(100.0 * assessment.coverage, 0) + " % of the image, up to " +
          fixed_text(100.0 * assessment.reach, 0) + " % of the way to its corners; board tilted by up to " +
          fixed_text(assessment.largest_tilt * degrees_of_radian, 0) + " degrees\n\n  corners  error px  tilt  view\n";
  for (const CalibratedView& view : calibration.views)
    text += "  " + padded(std::to_string(view.view.corners.size()), 7) + padded(fixed_text(view.rms, 3), 10) +
            padded(fixed_text(view.tilt * degrees_of_radian, 0), 6) + "  " + view.view.name +
            (view.is_used ? "" : "  (left out)") + "\n";
  if (!assessment.advice.empty()) text += "\nTo make it better:\n";
  for (const std::string& advice : assessment.advice) text += "- " + advice + "\n";
  return text;
}

std::string to_json(const Calibration& calibration, const CalibrationAssessment& assessment,
                    const CalibrationBoard& board) {
  using Json = nlohmann::ordered_json;
  const Camera& camera = calibration.camera;
  Json json = {{"camera", {{"width", camera.width}, {"height", camera.height}}},
               {"board",
                {{"pattern", board_pattern_name(board.pattern)},
                 {"columns", board.columns},
                 {"rows", board.rows},
                 {"square", board.square}}},
               {"rms", calibration.rms},
               {"standard_deviations", Json::object()},
               {"coverage", assessment.coverage},
               {"cells",
                {{"columns", CalibrationAssessment::cell_columns},
                 {"rows", CalibrationAssessment::cell_rows},
                 {"corners", assessment.cells}}},
               {"reach", assessment.reach},
               {"largest_tilt_degrees", assessment.largest_tilt * degrees_of_radian},
               {"views", Json::array()},
               {"trouble", assessment.trouble.empty() ? Json() : Json(assessment.trouble)},
               {"advice", assessment.advice}};
  json["camera"]["lens"] = lens_name(camera.distortion.lens);
  for (const CalibratedNumber& number : calibration.numbers) {
    json["camera"][number.name] = number.value;
    json["standard_deviations"][number.name] = finite(number.standard_deviation);
  }
  for (const CalibratedView& view : calibration.views)
    json["views"].push_back({{"name", view.view.name},
                             {"corners", view.view.corners.size()},
                             {"rms", finite(view.rms)},
                             {"tilt_degrees", view.tilt * degrees_of_radian},
                             {"used", view.is_used}});
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace holdfast
