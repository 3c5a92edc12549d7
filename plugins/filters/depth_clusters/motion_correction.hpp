// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "holdfast/depth_blocks/depth_view.hpp"

namespace holdfast::depth_clusters_plugin {

using depth_blocks::BlockGrid;
using depth_blocks::DepthNoise;
using depth_blocks::DepthView;

/// Surface area of a block up to a factor: the squared depth, limited because large depths are inexact.
inline float surface_of(float depth) {
  constexpr float max_depth = 4.0F;  // m
  return depth < max_depth ? depth * depth : max_depth * max_depth;
}

/// Corrects a predicted motion so that the depth and brightness of `now`, warped into `past`, agree with `past` (Jaimez
/// et al. 2017, equations 2 to 6: iteratively reweighted least squares with Cauchy weights, linearised in the image of
/// `past`). Blocks are weighted by `trust` (of the blocks of `now`).
///
/// A moving object that fills the view can bias the prediction and this optimization. Therefore a second optimization
/// weights blocks by their surface area, which is small for near objects, and is preferred if its motion explains
/// clearly more surface.
class MotionCorrection {
 public:
  MotionCorrection(const BlockGrid& grid, const DepthNoise& noise, double largest)
      : grid_(grid), noise_(noise), largest_(largest) {}

  /// `motion` is T_past_now. Returns false and leaves the motion unchanged if the correction would be larger than
  /// `largest` [m, and 2 rad per m].
  bool correct(const DepthView& now, const DepthView& past, const std::vector<float>& trust, Eigen::Isometry3d& motion);

 private:
  using Vector6f = Eigen::Matrix<float, 6, 1>;
  using Matrix6f = Eigen::Matrix<float, 6, 6>;
  enum class Weighting { by_noise, by_surface };

  /// One pass over the blocks: how they are weighted, the scale of the noise, and whether only the cost is wanted.
  struct Pass {
    Weighting weighting;
    float scale;
    bool only_cost = false;
  };

  float sum_up(const DepthView& now, const DepthView& past, const std::vector<float>& trust, const Pass& pass,
               const Eigen::Isometry3d& motion);
  bool descend(const DepthView& now, const DepthView& past, const std::vector<float>& trust, Weighting weighting,
               Eigen::Isometry3d& motion, float& cost);

  const BlockGrid& grid_;
  DepthNoise noise_;
  double largest_;
  Matrix6f H_;
  Vector6f g_;
};

}  // namespace holdfast::depth_clusters_plugin
