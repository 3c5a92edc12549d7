// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "holdfast/depth_blocks/depth_view.hpp"

namespace holdfast::cluster_plugin {

using depth_blocks::BlockGrid;
using depth_blocks::DepthNoise;
using depth_blocks::DepthView;

/// How much surface a block shows, up to a factor: the square of its depth, limited where depth becomes vague.
inline float surface_of(float depth) {
  constexpr float most = 4.0F;  // m
  return depth < most ? depth * depth : most * most;
}

/// Corrects a predicted motion so that the depth and the brightness of `now`, carried into `past`, agree with it
/// (Jaimez et al. 2017, equations 2 to 6: iteratively reweighted least squares with Cauchy weights; linearised in the
/// image of `past`). Blocks weigh by `trust` (of now's blocks).
///
/// A thing that fills the view can lead the prediction, and this descent, along. So a second descent weighs blocks by
/// the surface that they show, which a near thing has little of, and wins when its motion explains clearly more of the
/// surface.
class MotionCorrection {
 public:
  MotionCorrection(const BlockGrid& grid, const DepthNoise& noise, double largest)
      : grid_(grid), noise_(noise), largest_(largest) {}

  /// `motion` is T_past_now. Returns false, and leaves the motion as it was, when the correction would be larger than
  /// `largest` [m, and 2 rad per m].
  bool correct(const DepthView& now, const DepthView& past, const std::vector<float>& trust, Eigen::Isometry3d& motion);

 private:
  using Vector6f = Eigen::Matrix<float, 6, 1>;
  using Matrix6f = Eigen::Matrix<float, 6, 6>;
  enum class Weighting { by_noise, by_surface };

  float sum_up(const DepthView& now, const DepthView& past, const std::vector<float>& trust, Weighting weighting,
               float scale, bool only_cost, const Eigen::Isometry3d& motion);
  bool descend(const DepthView& now, const DepthView& past, const std::vector<float>& trust, Weighting weighting,
               Eigen::Isometry3d& motion, float& cost);

  const BlockGrid& grid_;
  DepthNoise noise_;
  double largest_;
  Matrix6f H_;
  Vector6f g_;
};

}  // namespace holdfast::cluster_plugin
