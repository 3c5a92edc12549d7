// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/core/map.hpp"

namespace holdfast {

/// Whether lengths of the map are metres: its sensor measures them, or MapInertia::scale is exactly 1, as after
/// make_metric().
bool is_metric(const Map& map);

/// Scales the map of one camera to metres, by MapInertia::scale, which becomes 1. Poses that are kept relative to
/// keyframes follow by KeyFrame::scale. Does nothing to a metric map, nor without inertial estimates. Increments the
/// version. The estimates must belong to all keyframes: the map has one submap.
void make_metric(Map& map);

}  // namespace holdfast
