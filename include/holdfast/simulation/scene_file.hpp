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
/// order. All errors of the text are reported together; errors that depend on the room (a missing chair) are reported
/// by Simulator. An empty path denotes an empty file: the office without people. Throws ConfigurationError.
Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});

/// The parameter tables of a scene's sections, for references: "scene", "scene.camera", "scene.people.do.walk", ...
std::vector<SectionDescription> scene_sections();

}  // namespace holdfast::simulation
