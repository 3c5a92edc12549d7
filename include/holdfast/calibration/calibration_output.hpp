// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "holdfast/calibration/assessment.hpp"
#include "holdfast/calibration/calibration.hpp"

namespace holdfast {

/// The section `camera` of a configuration, with a comment on its origin.
std::string camera_yaml(const Calibration& calibration, const CalibrationBoard& board);
/// Text report: errors, parameters with standard deviations, coverage, views, advice.
std::string to_text(const Calibration& calibration, const CalibrationAssessment& assessment);
/// The same for programs.
std::string to_json(const Calibration& calibration, const CalibrationAssessment& assessment,
                    const CalibrationBoard& board);
/// A picture 8UC3: where corners were found and how far each is from where it is expected, the scatter of these
/// differences, and the error of each view.
cv::Mat calibration_plot(const Calibration& calibration, const CalibrationAssessment& assessment);

}  // namespace holdfast
