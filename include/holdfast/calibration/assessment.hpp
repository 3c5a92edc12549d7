// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "holdfast/calibration/calibration.hpp"

namespace holdfast {

/// Quality of a calibration, and advice for improving it.
struct CalibrationAssessment {
  static constexpr int cell_columns = 10;
  static constexpr int cell_rows = 8;

  /// Corners of used views in each cell of a grid over the image, row by row.
  std::vector<int> cells;
  double coverage = 0.0;  ///< share of cells with a corner
  /// Distance of the outermost corner from the centre of the image, relative to half its diagonal: distortion beyond is
  /// extrapolated.
  double reach = 0.0;
  double largest_tilt = 0.0;  ///< of the used views [rad]
  /// Describes why the result cannot be used; empty if it can.
  std::string trouble;
  /// Advice for further views or checks; empty if nothing is missing.
  std::vector<std::string> advice;
};

/// A result is unusable if the focal length is uncertain by more than 2 %, if every view shows the board within 8
/// degrees of parallel to the image, where focal length and distance are ambiguous, or if the distortion has no inverse
/// in the image (Camera::trouble).
CalibrationAssessment assess(const Calibration& calibration);

}  // namespace holdfast
