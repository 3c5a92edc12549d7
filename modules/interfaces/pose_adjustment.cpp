// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/geometry/pose_adjustment.hpp"

#include "holdfast/interfaces/optimizer.hpp"

namespace holdfast::geometry {

template PoseSummary adjust_pose(PoseProblem& problem, const PoseAdjustmentOptions& options);

}  // namespace holdfast::geometry
