// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/core/frame_result.hpp"

namespace holdfast {

/// Whether the pose was found after tracking was lost or in a loaded map, so that it need not continue the previous
/// one.
constexpr bool is_after_loss(TrackingMethod method) {
  return method == TrackingMethod::recovered || method == TrackingMethod::relocalised;
}

}  // namespace holdfast
