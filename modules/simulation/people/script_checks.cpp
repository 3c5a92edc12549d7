// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string_view>
#include <utility>

#include "holdfast/core/error.hpp"
#include "script_builder.hpp"

namespace holdfast::simulation {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {
constexpr double from_wall = 0.2;  // the middle of one who stands [m]
constexpr double touching = 0.02;  // [m]

// Classes of loose things; what belongs to the building, hangs, or bears many things is not among them.
constexpr std::array<std::string_view, 4> pushable{"box", "chair", "plant", "stool"};
constexpr std::array<std::string_view, 13> portable{"book",    "box",   "chair",    "keyboard", "lamp",
                                                    "monitor", "mug",   "package",  "paper",    "pen holder",
                                                    "plant",   "stool", "telephone"};

template <std::size_t count>
bool one_of(const std::array<std::string_view, count>& classes, const std::string& name) {
  return std::find(classes.begin(), classes.end(), name) != classes.end();
}

/// The boxes around these enclose the room.
bool is_shell(const ThingPlace& place) {
  return place.class_name == "wall" || place.class_name == "floor" || place.class_name == "ceiling";
}

std::string in_metres(double length) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f m", length);
  return text.data();
}
std::string in_centimetres(double length) { return std::to_string(std::lround(100.0 * length)) + " cm"; }
}  // namespace

bool ScriptBuilder::others(const std::string& person) const { return !person.empty() && person != plan_.name; }

ThingPlace& ScriptBuilder::thing(const std::string& name, const std::string& doing) {
  const auto found = things_.find(name);
  if (found == things_.end()) {
    // Those of the same class, or all.
    const std::string wanted = name.substr(0, name.find(' '));
    std::string similar, all;
    for (const auto& [known, place] : things_) {
      if (place.class_name == wanted) similar += (similar.empty() ? "" : ", ") + known;
      all += (all.empty() ? "" : ", ") + known;
    }
    refuse("wants to " + doing + " '" + name + "', which is not in the room; " +
           (!similar.empty() ? "there are " + similar
            : !all.empty()   ? "known are " + all
                             : "there is nothing in the room"));
  }
  ThingPlace& place = found->second;
  if (of_another(place))
    refuse("wants to " + doing + " '" + name + "', which " +
           (others(place.moved_by) ? place.moved_by + " moves" : place.used_by + " uses") +
           "; let one person do it, or take different things");
  return place;
}

std::string ScriptBuilder::hindrance(const std::string& name, Handling handling) const {
  const ThingPlace& place = things_.at(name);
  const bool pushed = handling == Handling::push;
  if (pushed ? !one_of(pushable, place.class_name) : !one_of(portable, place.class_name))
    return "which is a " + place.class_name + " and stays where it is";
  const double width = place.extents.sizes().head<2>().minCoeff(), height = rest(name).translation().z();
  if (!pushed && width > widest_load)
    return "which is " + in_centimetres(width) + " wide; expected at most " + in_centimetres(widest_load);
  if (pushed && std::abs(height) > touching)
    return "which is " + in_centimetres(height) + " above the floor; only what stands on the floor can be pushed";
  if (const std::string above = thing_on(name); !above.empty()) return "on which '" + above + "' stands";
  return "";
}

ThingPlace& ScriptBuilder::claim(const std::string& name, Handling handling) {
  const std::string doing = handling == Handling::push ? "push" : "carry";
  ThingPlace& place = thing(name, doing);
  if (const std::string hindered = hindrance(name, handling); !hindered.empty()) {
    std::vector<std::pair<double, std::string>> instead;
    for (const auto& [other, there] : things_)
      if (!of_another(there) && hindrance(other, handling).empty())
        instead.emplace_back((rest(other).translation() - rest(name).translation()).norm(), other);
    std::sort(instead.begin(), instead.end());
    std::string names;
    for (std::size_t i = 0; i < std::min<std::size_t>(5, instead.size()); ++i)
      names += (i == 0 ? "" : ", ") + instead[i].second;
    refuse("wants to " + doing + " '" + name + "', " + hindered + "; " +
           (names.empty() ? "nothing in the room can be used for that" : "the nearest to be used for that: " + names));
  }
  place.moved_by = plan_.name;
  movement_.things.try_emplace(name, place.T_world_thing);
  return place;
}

bool ScriptBuilder::in_footprint(const std::string& name, const Vector3d& point) const {
  const ThingPlace& place = things_.at(name);
  const Vector2d local = (rest(name).inverse() * point).head<2>();
  return (local - place.extents.min().head<2>()).minCoeff() > 0 &&
         (place.extents.max().head<2>() - local).minCoeff() > 0;
}

double ScriptBuilder::bearing_height(const std::string& name) const {
  const ThingPlace& place = things_.at(name);
  return rest(name).translation().z() + (place.class_name == "chair" ? seat_height : place.extents.max().z());
}

std::string ScriptBuilder::thing_on(const std::string& name) const {
  const double height = bearing_height(name), ground = rest(name).translation().z();
  for (const auto& [other, place] : things_) {
    const Vector3d foot = rest(other) * Vector3d(0, 0, place.extents.min().z());
    // What stands beside something thin stands within its footprint without being on it.
    if (other != name && !is_shell(place) && std::abs(foot.z() - height) < touching && foot.z() > ground + 0.001 &&
        in_footprint(name, foot))
      return other;
  }
  return "";
}

void ScriptBuilder::check_put_down(const Carry& action) {
  const Vector3d& at = action.put_at;
  if (!walls_.contains(Vector3d(at.x(), at.y(), walls_.center().z())))
    refuse("cannot put down '" + action.thing + "' at " + in_metres(at.x()) + ", " + in_metres(at.y()) +
           ", which is outside the room; expected x from " + in_metres(walls_.min().x()) + " to " +
           in_metres(walls_.max().x()) + " and y from " + in_metres(walls_.min().y()) + " to " +
           in_metres(walls_.max().y()));
  double nearest = 0.0;
  std::string bearer;  // none: the floor
  for (const auto& [name, place] : things_) {
    if (name == action.thing || is_shell(place) || !in_footprint(name, at)) continue;
    const double height = bearing_height(name);
    if (std::abs(height - at.z()) < std::abs(nearest - at.z())) nearest = height, bearer = name;
  }
  if (std::abs(nearest - at.z()) > touching)
    refuse("cannot put down '" + action.thing + "' at a height of " + in_metres(at.z()) +
           ", where nothing bears it; expected " + in_metres(nearest) + ", " +
           (bearer.empty() ? "the floor" : "the top of '" + bearer + "'"));
  // From then on nobody else may move what bears it.
  if (!bearer.empty() && one_of(portable, things_.at(bearer).class_name))
    thing(bearer, "put something on").used_by = plan_.name;
}

Isometry3d ScriptBuilder::rest(const std::string& name) const {
  const auto moved = movement_.things.find(name);
  return moved != movement_.things.end() ? moved->second.rest() : things_.at(name).T_world_thing;
}

void ScriptBuilder::check_positive(double value, const std::string& what) const {
  if (!(value > 0.0)) refuse("has " + std::to_string(value) + " as " + what + "; expected more than 0");
}

void ScriptBuilder::check_route(const std::vector<Vector2d>& to, const std::string& doing) const {
  if (to.empty()) refuse("is to " + doing + " along a route without places; expected at least one");
}

void ScriptBuilder::refuse(const std::string& problem) const {
  throw ConfigurationError({}, "do." + std::to_string(action_number_) + ": " +
                                   (plan_.name.empty() ? "a person" : plan_.name) + " " + problem);
}

bool ScriptBuilder::free_to_stand(const Vector2d& position, const std::string& except) const {
  const Vector2d from_low = position - walls_.min().head<2>(), from_high = walls_.max().head<2>() - position;
  if (std::min(from_low.minCoeff(), from_high.minCoeff()) < from_wall) return false;
  for (const auto& [name, place] : things_) {
    if (name == except || is_shell(place)) continue;
    const Isometry3d pose = rest(name);
    const double ground = pose.translation().z() + place.extents.min().z();
    if (ground + place.extents.sizes().z() < 0.05 || ground > 1.8) continue;
    Vector3d local = pose.inverse() * flat(position);
    local.z() = place.extents.center().z();
    if (place.extents.exteriorDistance(local) < 0.12) return false;
  }
  return true;
}

}  // namespace holdfast::simulation
