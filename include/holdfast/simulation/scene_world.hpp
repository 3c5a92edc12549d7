// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "holdfast/simulation/scene.hpp"
#include "holdfast/simulation/world.hpp"

namespace holdfast::simulation {

/// An object that may move in a scene, as masks and truth name it.
struct NumberedObject {
  std::uint8_t number = 0;  ///< from 1
  std::size_t index = 0;    ///< in World::objects
};

/// The room of a scene with everybody in it and everything in motion.
struct SceneWorld {
  World world;
  Stage stage;
  std::vector<NumberedObject> numbered;  ///< people in the order of the scene, then things in the order of the world
};

/// Furnishes the room, makes the people and sets what they and the doors move in motion. Throws ConfigurationError for
/// a plan that the room does not allow: things that are not there, two who move the same one, ... The message names the
/// scene's file and the element ("people.0.do.1").
SceneWorld make_scene_world(const Scene& scene);

/// The same in a room from furnish_room(scene.room, scene.seed), for those who need it more than once: painting its
/// textures takes most of the time.
SceneWorld make_scene_world(const Scene& scene, Room furnished);

}  // namespace holdfast::simulation
