// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "holdfast/simulation/stage.hpp"
#include "holdfast/simulation/world.hpp"

/// The rooms that make_room can make, each in a file of its own.
namespace holdfast::simulation {

Stage office_stage();
World make_office(std::uint64_t seed);
Stage hall_stage();
World make_hall(std::uint64_t seed);
Stage corridor_stage();
World make_corridor(std::uint64_t seed);
Stage open_plan_stage();
World make_open_plan(std::uint64_t seed);

}  // namespace holdfast::simulation
