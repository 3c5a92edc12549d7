// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "holdfast/calibration/calibration.hpp"

namespace holdfast {

/// How far a calibration can be trusted, and what would make it better.
struct CalibrationAssessment {
  static constexpr int cell_columns = 10;
  static constexpr int cell_rows = 8;

  /// Corners of used views in each cell of a grid over the image, row by row.
  std::vector<int> cells;
  double coverage = 0.0;  ///< share of cells with a corner
  /// Distance of the outermost corner from the middle of the image, as a share of half its diagonal: distortion farther
  /// out is extrapolated.
  double reach = 0.0;
  double largest_tilt = 0.0;  ///< of the used views [rad]
  /// Why the result cannot be used; empty when it can.
  std::string trouble;
  /// What to photograph next, or what to look at; empty when nothing is missing.
  std::vector<std::string> advice;
};

/// A result is of no use when the focal length is uncertain by more than 2 %, or when every view shows the board within
/// 8 degrees of parallel to the image: a board of another size or distance would look the same through another lens.
/// Nor when the distortion has no inverse in the image (Camera::trouble).
CalibrationAssessment assess(const Calibration& calibration);

}  // namespace holdfast
