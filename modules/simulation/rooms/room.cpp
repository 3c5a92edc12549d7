// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/room.hpp"

#include <utility>

#include "holdfast/core/error.hpp"
#include "rooms.hpp"

namespace holdfast::simulation {

namespace {
constexpr std::pair<RoomKind, const char*> room_kinds[] = {{RoomKind::office, "office"},
                                                           {RoomKind::hall, "hall"},
                                                           {RoomKind::corridor, "corridor"},
                                                           {RoomKind::open_plan, "open_plan"}};
}

const char* to_string(RoomKind kind) {
  for (const auto& [known, name] : room_kinds)
    if (known == kind) return name;
  return "";
}

std::vector<std::string> room_names() {
  std::vector<std::string> names;
  for (const auto& [kind, name] : room_kinds) names.emplace_back(name);
  return names;
}

RoomKind room_kind(const std::string& name) {
  for (const auto& [kind, known] : room_kinds)
    if (name == known) return kind;
  throw ConfigurationError(SourceLocation{},
                           "room '" + name + "' is not known; expected office, hall, corridor or open_plan");
}

Stage make_stage(RoomKind kind) {
  switch (kind) {
    case RoomKind::office:
      return office_stage();
    case RoomKind::hall:
      return hall_stage();
    case RoomKind::corridor:
      return corridor_stage();
    case RoomKind::open_plan:
      return open_plan_stage();
  }
  return {};
}

Room furnish_room(RoomKind kind, std::uint64_t seed) {
  switch (kind) {
    case RoomKind::office:
      return {make_office(seed), office_stage()};
    case RoomKind::hall:
      return {make_hall(seed), hall_stage()};
    case RoomKind::corridor:
      return {make_corridor(seed), corridor_stage()};
    case RoomKind::open_plan:
      return {make_open_plan(seed), open_plan_stage()};
  }
  return {};
}

Room make_room(RoomKind kind, std::uint64_t seed) {
  Room room = furnish_room(kind, seed);
  bake_light(room.world);
  return room;
}

}  // namespace holdfast::simulation
