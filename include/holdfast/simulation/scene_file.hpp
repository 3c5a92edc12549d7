// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "holdfast/config/configuration.hpp"
#include "holdfast/simulation/scene.hpp"

/// Scenes as YAML files; docs/scenes.md explains them.
namespace holdfast::simulation {

/// Reads a scene. `overrides` are "key.path=value" as on the command line ("people.0.do.1.walk.speed=0.5"), applied in
/// order. Everything that is wrong with the text is reported at once; what only the room can tell (a chair that is not
/// there) is found by Simulator. An empty path stands for an empty file: the office with nobody in it. Throws
/// ConfigurationError.
Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});

/// The parameter tables of a scene's sections, for references: "scene", "scene.camera", "scene.people.do.walk", ...
std::vector<SectionDescription> scene_sections();

}  // namespace holdfast::simulation
