// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "holdfast/calibration/calibration.hpp"

namespace holdfast {

/// Least squares over a camera and the poses of a board. The poses of the views are independent of each other given the
/// camera, so that they are eliminated from the normal equations.
class CalibrationProblem {
 public:
  struct View {
    std::vector<Eigen::Vector3d> points;  ///< in the board frame [m]
    std::vector<Eigen::Vector2d> pixels;  ///< raw image positions
    Eigen::Isometry3d T_camera_board = Eigen::Isometry3d::Identity();
  };

  /// `coefficients`: as CalibrationOptions::coefficients.
  CalibrationProblem(const Camera& start, int coefficients, std::vector<View> views);

  const Camera& camera() const { return camera_; }
  const std::vector<View>& views() const { return views_; }
  std::vector<View>& views() { return views_; }

  /// Finds the pose of every view anew for the present camera, from its corners alone.
  void find_poses();
  /// At most so many steps of the first `free` numbers and all poses. Returns the sum of squared errors [px^2];
  /// infinite when a corner lies behind the camera from the beginning.
  double minimise(int steps, int free);
  double minimise(int steps) { return minimise(steps, static_cast<int>(names_.size())); }

  /// Found minus expected positions of the corners of a view [px]; empty when one of them lies behind the camera.
  static std::vector<Eigen::Vector2d> residuals(const Camera& camera, const View& view);

  /// fx, fy, cx, cy and the coefficients that are estimated.
  const std::vector<std::string>& names() const { return names_; }
  static double value(const Camera& camera, const std::string& name);
  /// Standard deviations of the numbers for corners whose coordinates scatter by one pixel; infinite where the views do
  /// not determine them.
  Eigen::VectorXd unit_deviations() const;

 private:
  struct Equations;
  double cost(const Camera& camera, const std::vector<View>& views) const;
  Equations equations(int free) const;

  Camera camera_;
  std::vector<std::string> names_;
  std::vector<View> views_;
};

}  // namespace holdfast
