// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/geometry/pnp.hpp"

#include "holdfast/interfaces/optimizer.hpp"

namespace holdfast::geometry {

template PoseSummary find_pose(PoseProblem& problem, const PnpOptions& options);

}  // namespace holdfast::geometry
