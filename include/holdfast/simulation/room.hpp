// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "holdfast/simulation/stage.hpp"
#include "holdfast/simulation/world.hpp"

namespace holdfast::simulation {

/// A furnished and lit room with one corner at the origin: x to the right and y ahead as seen from the camera's home.
///
/// office: 6 m by 5 m by 2.6 m. Two desks with objects are at the wall y = 5, in the view of the camera, and left of
/// them "door 1", which opens into the room when it is rotated about its z axis (its hinge) by 0 to 1.4 rad. "box 3" on
/// a stool in front of the desks can be carried; "chair 1" and "chair 2" are on either side of it.
///
/// hall: 11 m by 9 m by 2.8 m. Furniture along all walls, islands of desks, shelves and partitions, and a table with
/// free floor around it, so that every part of a walk around the islands looks different.
///
/// corridor: 20 m by 2.6 m by 2.6 m. The same desk group every 2 m along y = 2.6 and the same cabinet and pictures on
/// the opposite side with identical textures; only a mug on some of the desks distinguishes them.
///
/// open_plan: 12 m by 9 m by 2.8 m. Three rows of four desks with one or two screens each and chairs of one model, and
/// furnished walls around them.
enum class RoomKind { office, hall, corridor, open_plan };

/// "office", "hall", "corridor", "open_plan".
const char* to_string(RoomKind kind);
/// The kind of that name; throws ConfigurationError naming the known ones.
RoomKind room_kind(const std::string& name);
std::vector<std::string> room_names();

/// A furnished room, and the positions of people and cameras in it.
struct Room {
  World world;
  Stage stage;
};

/// Creates a room. The seed changes all textures and the positions of small objects, not the furniture.
Room make_room(RoomKind kind, std::uint64_t seed);

/// Creates a room without baked light, so that objects can be set in motion first and leave no shadow at their initial
/// position; call bake_light afterwards.
Room furnish_room(RoomKind kind, std::uint64_t seed);

/// Makes a room that furnish_room() made what it is on another visit: chairs stand at each other's places, turned and
/// pushed by up to 0.35 m, and screens show other pictures, half of which another screen showed on the first visit.
/// Visits 0 and 1 change nothing.
void rearrange(World& world, std::uint64_t seed, std::uint64_t visit);

/// The positions of a room only; independent of the seed.
Stage make_stage(RoomKind kind);

}  // namespace holdfast::simulation
