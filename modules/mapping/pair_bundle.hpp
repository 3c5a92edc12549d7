// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "holdfast/core/stereo_calibration.hpp"
#include "holdfast/interfaces/optimizer.hpp"

namespace holdfast {

/// Bundle adjustment of keyframes of a stereo pair with the displacement of columns as more unknowns: poses, points,
/// and those of ColumnEstimate. The disparity of a point at depth z is
///
///   x - right_x = fx * baseline / z - (c + q r^2 + m x + k x r^2),   r^2 = x^2 + y^2 in the right image
///
/// so that near points determine the scale of the motion, and far points, triangulated over it, the displacement.
/// Gauss-Newton with Huber's weights; the points are eliminated first, and then the poses (two Schur complements):
///
///   | S_tt  S_te |   poses (the first one is fixed)
///   | S_et  S_ee |   c, q, m, k;   their information: S_ee - S_et S_tt^-1 S_te
///
/// The information is divided by the variance of unit weight where this exceeds 1.
class PairBundle {
 public:
  /// Nothing if there are too few points, if the motion is shorter than five baselines, if the adjustment does not
  /// converge, or if no pair can have such errors. `problem`: observations sorted by point; its first pose is fixed; it
  /// is changed.
  std::optional<ColumnEstimate> solve(BundleProblem& problem);

 private:
  bool iterate(BundleProblem& problem, bool rejects);
  void add_point(const BundleProblem& problem, std::size_t first, std::size_t last, bool rejects);

  Eigen::Vector4d columns_;
  Eigen::MatrixXd system_;
  Eigen::VectorXd gradient_;
  ColumnEstimate result_;
  double squared_sum_ = 0.0;
  int rows_ = 0;
  // By observation, for the elimination of one point and the substitution of its step.
  struct Coupling {
    std::size_t pose;
    Eigen::Matrix<double, 3, 6> by_pose;
  };
  struct PointTerms {
    Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    Eigen::Matrix<double, 3, 4> by_columns = Eigen::Matrix<double, 3, 4>::Zero();
    std::size_t first = 0, last = 0;  // of couplings_
  };
  std::vector<Coupling> couplings_;
  std::vector<PointTerms> points_;
};

}  // namespace holdfast
