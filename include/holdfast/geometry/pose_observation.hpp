// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "holdfast/core/frame.hpp"
#include "holdfast/interfaces/optimizer.hpp"

namespace holdfast::geometry {

/// Adds what a feature of a frame says about the frame's pose: it shows `point` (world [m]). Weighted by the
/// probability that the feature belongs to the static world.
inline void add_observation(PoseProblem& problem, const Frame& frame, std::size_t feature,
                            const Eigen::Vector3d& point) {
  problem.points.push_back(point);
  problem.x.push_back(frame.x[feature]);
  problem.y.push_back(frame.y[feature]);
  problem.right_x.push_back(frame.right_x[feature]);
  problem.inverse_sigma2.push_back(frame.pyramid->inverse_sigma2[frame.features.octave[feature]]);
  problem.weight.push_back(frame.static_probability[feature]);
}

}  // namespace holdfast::geometry
