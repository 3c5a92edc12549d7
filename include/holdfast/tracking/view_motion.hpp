// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/interfaces/feature_matcher.hpp"
#include "holdfast/tracking/rolling_shutter.hpp"

namespace holdfast {

/// The features that are more likely static than moving, by rising index.
std::vector<std::uint32_t> static_features(const Frame& frame);

/// The motion of one camera since the previous frame while there is no map: the rotation between the static features of
/// both frames that match (geometry::view_rotation), without a translation, since the parallax of one frame interval is
/// small. `max_distance`: of descriptors. Empty if too few features match, or without a previous frame.
std::optional<FrameMotion> rotation_since(const Frame& previous, const Frame& frame, const FeatureMatcher& matcher,
                                          float max_distance);

}  // namespace holdfast
