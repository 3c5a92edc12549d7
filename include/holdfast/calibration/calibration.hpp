// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "holdfast/calibration/board_detector.hpp"
#include "holdfast/core/camera.hpp"

namespace holdfast {

/// Options of a calibration.
struct CalibrationOptions {
  Lens lens = Lens::radial_tangential;
  /// Distortion coefficients of a radial_tangential lens: 4 (k1, k2, p1, p2), 5 (and k3) or 8 (and k4, k5, k6). A
  /// fisheye lens always has 4 (k1 to k4).
  int coefficients = 5;
  /// Also use outlier views.
  bool keep_all_views = false;
};

/// An estimated parameter of the camera.
struct CalibratedNumber {
  std::string name;  ///< as in the section `camera` of a configuration: "fx"
  double value = 0.0;
  /// Standard deviation from the scatter of the corners; infinite if the views do not determine the parameter.
  double standard_deviation = 0.0;
};

/// A view and its residuals.
struct CalibratedView {
  BoardView view;
  bool is_used = true;  ///< false: excluded as an outlier
  Eigen::Isometry3d T_camera_board = Eigen::Isometry3d::Identity();
  std::vector<Eigen::Vector2d> residuals;  ///< found minus expected position of each corner [px]
  double rms = 0.0;                        ///< root mean square of their lengths [px]
  /// Angle between the normal of the board and the optical axis [rad]: 0 for a board parallel to the image.
  double tilt = 0.0;
};

/// A calibrated camera, with data for its assessment.
struct Calibration {
  Camera camera;
  std::vector<CalibratedNumber> numbers;
  std::vector<CalibratedView> views;  ///< in the order given
  double rms = 0.0;                   ///< over all corners of used views [px]

  std::size_t used_count() const;
  /// The number of that name; it must be one of those estimated.
  const CalibratedNumber& number(const std::string& name) const;
};

/// Estimates the camera that took the views: least squares of the reprojection error over intrinsics, distortion and
/// the pose of the board in each view (Zhang 2000), by Levenberg and Marquardt's method from several focal lengths.
/// Views are left out that disagree with the others: with more than three times the median error and more than half a
/// pixel, at most a quarter of all. Standard deviations are those of the linearised problem. Needs at least three views
/// of six corners; throws Error for fewer, or if no camera fits them.
Calibration calibrate(const std::vector<BoardView>& views, const CalibrationBoard& board, int width, int height,
                      const CalibrationOptions& options);

}  // namespace holdfast
