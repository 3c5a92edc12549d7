// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "holdfast/core/map.hpp"
#include "holdfast/run/run_record.hpp"

namespace holdfast {

/// Estimates by which factor the focal length of the camera is wrong, from a map whose features have depth. Sideways
/// motion tells nothing, because another motion explains the same images; a turn does: it changes depth by the angle
/// times the distance from the optical axis in metres, which is wrong by the factor, too. Gauss-Newton over the points
/// that two covisible keyframes measured, with the relative poses eliminated (Schur complement) and Huber weights.
/// Nothing without depth, or for a map that is too small.
std::optional<FocalRatio> estimate_focal_ratio(const Map& map);

/// The suspicion that the focal length is wrong, or nothing.
std::string focal_warning(const FocalRatio& focal, const Camera& camera);

}  // namespace holdfast
