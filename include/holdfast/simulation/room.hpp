// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "holdfast/simulation/world.hpp"

namespace holdfast::simulation {

/// A furnished office, lit: 6 m (x) by 5 m (y) by 2.6 m (z), one corner at the origin. Two desks with what lies on
/// desks stand at the wall y = 5, where CameraPath looks; shelves, cabinets, pictures, boxes and chairs around. The
/// seed changes every texture and the places of small things, not the furniture.
World make_room(std::uint64_t seed);

}  // namespace holdfast::simulation
