// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "holdfast/core/map.hpp"

namespace holdfast {

/// Selects which of two duplicate map points is kept.
enum class FusionSurvivor {
  more_observed,  ///< the one with more observations; of equal ones the point that was searched for
  searched_point  ///< the point that was searched for, because its position is more accurate
};

/// Result of add_or_fuse().
enum class FusionOutcome {
  nothing,            ///< the point was removed, or the keyframe already observes it
  observation_added,  ///< the feature had no point and observes this one now
  points_fused        ///< the feature observed another point, and the two were fused
};

/// Adds an observation of a map point by a keyframe's feature, or fuses the point with the one that the feature
/// observes already.
FusionOutcome add_or_fuse(Map& map, MapPointId point, KeyFrameId keyframe, std::uint32_t feature,
                          FusionSurvivor survivor);

}  // namespace holdfast
