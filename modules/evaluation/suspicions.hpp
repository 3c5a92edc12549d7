// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "holdfast/evaluation/evaluation.hpp"

namespace holdfast {

/// Checks whether the errors of a comparison have a cause other than the estimate, by the effect that this cause has on
/// the alignment: time stamps that are not seconds, a delayed clock, poses of the world in the camera, a left-handed
/// frame, another unit of length, a truth of another body than the camera, a truth that never moves, or poses without a
/// truth. Returns one sentence for each suspicion, with the remedy.
///
/// Both trajectories sorted, each stamp once, with the stamps as given; `pairs` are the associated indices of the truth
/// and of the estimate. `result` has all figures.
std::vector<std::string> suspicions(const Trajectory& truth, const Trajectory& estimate,
                                    const std::vector<std::pair<std::size_t, std::size_t>>& pairs,
                                    const Evaluation& result);

}  // namespace holdfast
