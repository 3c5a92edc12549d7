// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/scene_world.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/core/random.hpp"
#include "holdfast/plugin/did_you_mean.hpp"
#include "holdfast/simulation/person.hpp"
#include "holdfast/simulation/person_script.hpp"
#include "holdfast/simulation/swing.hpp"

namespace holdfast::simulation {

namespace {

/// The room's things as plans see them.
ThingPlaces things_of(const World& world) {
  ThingPlaces things;
  for (const Object& object : world.objects) {
    Eigen::AlignedBox3d extents;
    for (const Vertex& vertex : object.mesh.vertices) extents.extend(vertex.position.cast<double>());
    things[object.name] = {object.T_world_object, extents, object.class_name, "", ""};
  }
  return things;
}

Physique physique_of(const PersonPlan& plan, Random random) {
  Physique physique;
  const double height = 1.72 + 0.085 * std::clamp(random.normal(), -2.0, 2.0);
  const double girth = 1.0 + 0.13 * std::clamp(random.normal(), -1.5, 2.0);
  physique.height = plan.height.value_or(height);
  physique.girth = plan.girth.value_or(girth);
  return physique;
}

class SceneBuilder {
 public:
  SceneBuilder(const Scene& scene, Room furnished) : scene_(scene), room_(std::move(furnished)) {
    if (!scene.road) rearrange(room_.world, scene.seed, scene.visit);
    things_ = things_of(room_.world);
  }

  SceneWorld build() {
    for (std::size_t k = 0; k < scene_.people.size(); ++k) add_person(k);
    for (std::size_t k = 0; k < scene_.doors.size(); ++k) add_door(k);
    bake_light(room_.world);  // now that it is known what moves and leaves no lasting shadow
    SceneWorld result{std::move(room_.world), std::move(room_.stage), {}};
    number(result);
    return result;
  }

 private:
  /// `element` of the scene, as overrides name it, does not suit the room.
  [[noreturn]] void fail(const std::string& element, const std::string& message) const {
    throw ConfigurationError(SourceLocation{scene_.file}, element + message);
  }

  void add_person(std::size_t k) {
    const std::string element = "people." + std::to_string(k);
    PersonPlan plan = scene_.people[k];
    if (plan.name.empty()) plan.name = "person " + std::to_string(k + 1);
    const auto [namesake, is_new] = names_.emplace(plan.name, k);
    if (!is_new)
      fail(element, ".name: people." + std::to_string(namesake->second) + " is called '" + plan.name +
                        "' already; give each a name of its own");
    if (things_.contains(plan.name))
      fail(element, ".name: '" + plan.name + "' is a thing in the room; choose another name");
    const Random random = Random(scene_.seed).fork(0x9e0913).fork(k);
    auto skeleton = std::make_shared<const Skeleton>(physique_of(plan, random.fork(1)));
    // A plan that began before the first frame is played from its own beginning.
    const double before = std::max(0.0, -plan.start);
    plan.start = std::max(0.0, plan.start);
    const auto script = [&] {
      try {
        return std::make_shared<const PersonScript>(*skeleton, plan, things_, room_.stage.walls,
                                                    scene_.duration + before, random.fork(4));
      } catch (const ConfigurationError& error) {
        fail(element + ".", error.what());
      }
    }();
    Object person = make_person(room_.world, plan.name, *skeleton, random_look(random.fork(2)), random.fork(3));
    person.motion = [script, before](double time) { return script->T_world_person(time + before); };
    person.bones = [script, skeleton, before](double time) { return skeleton->place(script->posture(time + before)); };
    person.T_world_object = person.motion(0.0);
    room_.world.objects.push_back(std::move(person));
    for (const std::string& thing : script->moved_things())
      set_in_motion(thing,
                    [motion = script->thing_motion(thing), before](double time) { return motion(time + before); });
  }

  void add_door(std::size_t k) {
    const SwingPlan& plan = scene_.doors[k];
    const std::string element = "doors." + std::to_string(k);
    const auto place = things_.find(plan.thing);
    if (place == things_.end() || place->second.class_name != "door") {
      std::vector<std::string> doors;
      for (const auto& [name, thing] : things_)
        if (thing.class_name == "door") doors.push_back(name);
      fail(element, ".thing: there is no door '" + plan.thing + "' in the " + to_string(scene_.room) + "; " +
                        did_you_mean(plan.thing, doors));
    }
    if (!place->second.moved_by.empty())
      fail(element, ".thing: '" + plan.thing + "' is moved by " + place->second.moved_by + "; keep one of the two");
    const auto [other, is_new] = swinging_.emplace(plan.thing, k);
    if (!is_new)
      fail(element, ".thing: '" + plan.thing + "' swings already as doors." + std::to_string(other->second) +
                        "; keep one of them");
    try {
      set_in_motion(plan.thing, swing_motion(plan, place->second.T_world_thing));
    } catch (const ConfigurationError& error) {
      fail(element + ": ", error.what());
    }
  }

  void set_in_motion(const std::string& thing, std::function<Eigen::Isometry3d(double)> motion) {
    const auto object = std::find_if(room_.world.objects.begin(), room_.world.objects.end(),
                                     [&](const Object& candidate) { return candidate.name == thing; });
    object->motion = std::move(motion);
  }

  /// People first: number k is the k-th person of the scene.
  void number(SceneWorld& result) const {
    for (const bool people : {true, false})
      for (std::size_t i = 0; i < result.world.objects.size(); ++i) {
        const Object& object = result.world.objects[i];
        if (!object.moves() || (object.class_name == "person") != people) continue;
        if (result.numbered.size() >= 255) fail("", "more than 255 people and things move; masks hold no more");
        result.numbered.push_back({static_cast<std::uint8_t>(result.numbered.size() + 1), i});
      }
  }

  const Scene& scene_;
  Room room_;
  ThingPlaces things_;
  std::map<std::string, std::size_t> names_;     // of people, by number in the scene
  std::map<std::string, std::size_t> swinging_;  // doors, likewise
};

}  // namespace

SceneWorld make_scene_world(const Scene& scene) {
  if (!scene.road) return make_scene_world(scene, furnish_room(scene.room, scene.seed));
  try {
    return make_scene_world(scene, furnish_road(*scene.road, scene.duration * scene.camera.style.speed, scene.seed));
  } catch (const ConfigurationError& error) {
    throw ConfigurationError(SourceLocation{scene.file}, std::string("road: ") + error.what());
  }
}

SceneWorld make_scene_world(const Scene& scene, Room furnished) {
  return SceneBuilder(scene, std::move(furnished)).build();
}

}  // namespace holdfast::simulation
