// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/settings/schur.hpp"

namespace holdfast::schur_plugin {

/// Pose graph optimisation on SE(3). Residual of an edge: log(T_to_from^-1 * T_to_world * T_world_from) times the
/// square root of its weight, translation [m] before rotation [rad]; Levenberg-Marquardt with a sparse Cholesky factor.
///
/// With PoseGraphProblem::vertical, nodes move by left perturbations that keep roll and pitch.
///
/// Not usable (nothing changed): no free node with an edge, no fixed node for the gauge, numbers that are not finite, a
/// vertical without a direction.
/// Nodes that no chain of edges ties to a fixed node are held only by the damping. Indices out of range throw
/// CheckError.
GraphSummary adjust_pose_graph(PoseGraphProblem& problem, const SchurSettings& settings);

}  // namespace holdfast::schur_plugin
