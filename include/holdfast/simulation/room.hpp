// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "holdfast/simulation/stage.hpp"
#include "holdfast/simulation/world.hpp"

namespace holdfast::simulation {

/// A furnished room, lit, with one corner at the origin: x to the right and y ahead as seen from the camera's home.
///
/// office: 6 m by 5 m by 2.6 m. Two desks with what lies on desks stand at the wall y = 5, where the camera looks, and
/// left of them "door 1", which swings into the room when it is turned about its z axis by 0 to 1.4 rad (its hinge).
/// "box 3" on a stool before the desks can be carried; "chair 1" and "chair 2" stand on either side of it.
///
/// hall: 11 m by 9 m by 2.8 m. Furniture along all walls, islands of desks, shelves and partitions, and a table with
/// free floor around, so that a walk around the islands shows something else everywhere.
///
/// corridor: 20 m by 2.6 m by 2.6 m. The same desk group every 2 m along y = 2.6 and the same cabinet and pictures
/// across, copied to the texel; nothing but a mug on some of the desks tells one from another.
enum class RoomKind { office, hall, corridor };

/// "office", "hall", "corridor".
const char* to_string(RoomKind kind);
/// The kind of that name; throws ConfigurationError naming the known ones.
RoomKind room_kind(const std::string& name);
std::vector<std::string> room_names();

/// A furnished room, and where people and cameras can be in it.
struct Room {
  World world;
  Stage stage;
};

/// The seed changes every texture and the places of small things, not the furniture.
Room make_room(RoomKind kind, std::uint64_t seed);

/// The same before bake_light: for those who set things in motion first, which then leave no shadow where they stood.
Room furnish_room(RoomKind kind, std::uint64_t seed);

/// The places of a room alone: the same for every seed.
Stage make_stage(RoomKind kind);

}  // namespace holdfast::simulation
