// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "holdfast/core/frame.hpp"

namespace holdfast {

/// Whether a feature is more likely part of the static world than not; the map takes no others.
inline bool is_static(const Frame& frame, std::size_t feature) { return frame.static_probability[feature] >= 0.5F; }

}  // namespace holdfast
