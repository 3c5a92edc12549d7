// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "depth_view.hpp"

namespace holdfast::cluster_plugin {

/// Noise of a difference of two depths [m]: base + growth * depth^2.
struct DepthNoise {
  float base, growth;
  float at(float depth) const { return base + growth * depth * depth; }
};

/// Corrects a predicted motion so that the depth and the brightness of `now`, carried into `past`, agree with it
/// (Jaimez et al. 2017, equations 2 to 6: iteratively reweighted least squares with Cauchy weights; linearised in the
/// image of `past`). Blocks weigh by `trust` (of now's blocks) and by their depth: a far block is more surface, and a
/// near thing must not pass for the world because it fills the view. `motion` is T_past_now; false, and the motion as
/// it was, when the correction would be larger than `largest` [m, and 2 rad per m].
bool correct_motion(const BlockGrid& grid, const DepthView& now, const DepthView& past, const std::vector<float>& trust,
                    const DepthNoise& noise, double largest, Eigen::Isometry3d& motion);

}  // namespace holdfast::cluster_plugin
