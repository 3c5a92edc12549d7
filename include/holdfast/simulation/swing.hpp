// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <functional>

#include "holdfast/simulation/plan.hpp"

namespace holdfast::simulation {

/// Angle of a swinging object at a time [rad]: 0 closed, plan.angle open, smooth to the second derivative.
double swing_angle(const SwingPlan& plan, double time);

/// T_world_object over time of an object that swings about its own z axis, from its closed pose.
/// \throws ConfigurationError if a time of the plan is negative, or opening is 0.
std::function<Eigen::Isometry3d(double)> swing_motion(const SwingPlan& plan, const Eigen::Isometry3d& T_world_thing);

}  // namespace holdfast::simulation
