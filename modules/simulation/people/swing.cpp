// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/swing.hpp"

#include <cmath>

#include "curves.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast::simulation {

double swing_angle(const SwingPlan& plan, double time) {
  const double since = time - plan.start;
  if (since <= 0.0) return 0.0;
  const double round = 2.0 * plan.opening + plan.open + plan.shut;
  const double within = std::fmod(since, round);
  const Window window{0.0, plan.opening, plan.opening + plan.open, 2.0 * plan.opening + plan.open};
  return plan.angle * window.weight(within);
}

std::function<Eigen::Isometry3d(double)> swing_motion(const SwingPlan& plan, const Eigen::Isometry3d& T_world_thing) {
  if (!(plan.opening > 0.0) || plan.open < 0.0 || plan.shut < 0.0)
    throw ConfigurationError({}, "the swing of '" + plan.thing + "' has opening " + std::to_string(plan.opening) +
                                     " s, open " + std::to_string(plan.open) + " s, shut " + std::to_string(plan.shut) +
                                     " s; expected opening above 0, the others not negative");
  return [plan, T_world_thing](double time) {
    return T_world_thing * Eigen::AngleAxisd(swing_angle(plan, time), Eigen::Vector3d::UnitZ());
  };
}

}  // namespace holdfast::simulation
