// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/map_defaults.hpp"
#include "holdfast/interfaces/optimizer.hpp"

/// Observations of an optimizer's problems from the features of a frame. Each is weighted by the probability that its
/// feature belongs to the static world.
namespace holdfast {

/// Minimum number of shared points of a keyframe in a bundle adjustment: with fewer, its pose is weakly constrained and
/// may diverge for a slightly lower cost.
inline constexpr int minimum_shared_points = default_covisibility_minimum;

/// Changes of the pose of a weakly constrained keyframe above which an adjustment has diverged [m] and [rad]; its pose
/// is then rejected. The two adjustments bound different quantities:
/// @{
/// Local adjustment: the whole change, which contains the common motion of the neighbourhood and its correction.
inline constexpr double local_divergence = 0.5;
/// Full adjustment: the change relative to the parent, without the correction that both share; therefore smaller.
inline constexpr double divergence_from_parent = 0.2;
/// @}

/// Change of the pose of a keyframe that few points constrain, relative to its parent [m] and [rad], above which a
/// local adjustment has diverged, where inertial measurements determine this motion; 0 where they do not.
inline double inertial_divergence(const Frame& frame) {
  constexpr double smallest = 0.02, deviations = 4.0;
  if (frame.inertial_deviation <= 0.0) return 0.0;
  return std::clamp(deviations * frame.inertial_deviation, smallest, local_divergence);
}

/// Adds to the pose problem of `frame` that its feature number `feature` shows `point` (world [m]).
inline void add_observation(PoseProblem& problem, const Frame& frame, std::size_t feature,
                            const Eigen::Vector3d& point) {
  problem.points.push_back(point);
  problem.x.push_back(frame.x[feature]);
  problem.y.push_back(frame.y[feature]);
  problem.right_x.push_back(frame.right_x[feature]);
  problem.inverse_sigma2.push_back(frame.pyramid->inverse_sigma2[frame.features.octave[feature]]);
  problem.weight.push_back(frame.static_probability[feature]);
}

/// Builds the bundle-adjustment observation of a feature: pose number `pose`, that of the frame, observes point number
/// `point`.
inline BundleProblem::Observation bundle_observation(const Frame& frame, std::uint32_t feature, std::uint32_t pose,
                                                     std::uint32_t point) {
  return {.pose = pose,
          .point = point,
          .x = frame.x[feature],
          .y = frame.y[feature],
          .right_x = frame.right_x[feature],
          .inverse_sigma2 = frame.pyramid->inverse_sigma2[frame.features.octave[feature]],
          .weight = frame.static_probability[feature]};
}

}  // namespace holdfast
