// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>

#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/settings/ceres.hpp"

namespace holdfast::ceres_plugin {

/// Bundle adjustment by Levenberg-Marquardt on the Schur complement (Triggs et al. 2000, section 6.1), one thread.
///
/// A free pose is six numbers, its translation and a rotation vector applied from the left to where it started; fixed
/// poses are folded into the residuals. Phase one has Huber's cost; then observations beyond the chi-square limit are
/// set aside, and phase two has plain squares. At the end every observation is decided anew: `outlier` is also set for
/// points behind the camera and for numbers that are not finite.
///
/// Left as they are: points without an observation from a free pose, points with fewer than three residuals, poses
/// without observations. Not usable: nothing free, or a solver failure. Indices out of range throw CheckError. With no
/// fixed pose at all the gauge is held only by the damping.
BundleSummary adjust_bundle(BundleProblem& problem, const std::atomic<bool>& stop, const CeresSettings& settings);

}  // namespace holdfast::ceres_plugin
