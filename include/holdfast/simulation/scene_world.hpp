// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "holdfast/simulation/scene.hpp"
#include "holdfast/simulation/world.hpp"

namespace holdfast::simulation {

/// A movable object of a scene with its number in masks and ground truth.
struct NumberedObject {
  std::uint8_t number = 0;  ///< from 1
  std::size_t index = 0;    ///< in World::objects
};

/// The room of a scene with its people and moving objects.
struct SceneWorld {
  World world;
  Stage stage;
  std::vector<NumberedObject> numbered;  ///< people in the order of the scene, then objects in the order of the world
};

/// Furnishes the room, creates the people and sets the objects that they move, and the doors, in motion. Throws
/// ConfigurationError for a plan that the room does not permit, such as missing objects or an object that is moved by
/// two people. The message states the scene's file and the element ("people.0.do.1").
SceneWorld make_scene_world(const Scene& scene);

/// The same in a room from furnish_room(scene.room, scene.seed), for repeated use, because generating the textures of
/// the room takes most of the time.
SceneWorld make_scene_world(const Scene& scene, Room furnished);

}  // namespace holdfast::simulation
