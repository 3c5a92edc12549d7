// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/config/configuration_node.hpp"
#include "holdfast/core/camera.hpp"
#include "holdfast/plugin/registry.hpp"

namespace holdfast {

/// A section of plain parameters that belongs to no module: tracking, mapping.
struct SectionDescription {
  std::string name;
  std::string help;
  std::vector<Parameter> parameters;
  std::string kind = "section";  ///< heading that the reference lists it under
};

/// The `run` section.
struct RunSettings {
  std::string mode = "sequential";
  std::uint64_t seed = 1;
  std::string pace = "none";
  std::string late_frames = "queue";
  int frame_queue = 4;
  int keyframe_queue = 4;

  static void describe(ParameterTable<RunSettings>& table);
};

/// The `camera` section when it is a map: numbers, or a known name and what differs from it.
struct CameraSettings {
  std::string name;
  int width = 640, height = 480;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;
  double baseline = 0.08;
  double frame_rate = 30.0;

  static void describe(ParameterTable<CameraSettings>& table);
};

CameraSettings camera_settings(const Camera& camera);
Camera make_camera(const CameraSettings& settings);

/// Reads a `camera` section: a known name or a map of numbers. What is wrong is appended to `diagnostics`; the result
/// is nothing then.
std::optional<Camera> read_camera(const ConfigurationNode& node, std::vector<Diagnostic>& diagnostics);

/// A module that the configuration chose, with all its parameters, defaults included.
struct ModuleChoice {
  std::string kind;
  std::string name;
  ParameterValues values;
  SourceLocation location;  ///< of the name
};

/// A configuration that passed every check that can be made before modules exist.
struct Configuration {
  std::string file;
  ModuleChoice source, features, segmenter, optimizer, loop_detector;
  std::vector<ModuleChoice> filters;  ///< a chain
  std::vector<ModuleChoice> observers;
  std::optional<Camera> camera;  ///< nothing: the source must know it
  RunSettings run;
  std::map<std::string, ParameterValues> sections;  ///< by name, as described by the caller
  std::vector<std::string> plugins;                 ///< the files, absolute
};

/// Reads, overrides and checks a configuration. Plugins that it names are loaded into `registry` first. Throws
/// ConfigurationError with everything that is wrong.
Configuration load_configuration(const std::filesystem::path& file, const std::vector<std::string>& overrides,
                                 Registry& registry, const std::vector<SectionDescription>& sections);

/// The same for a tree that is already there; `file` names it in messages.
Configuration resolve_configuration(const ConfigurationNode& root, const std::string& file, Registry& registry,
                                    const std::vector<SectionDescription>& sections);

/// YAML that, loaded again, gives the same configuration: every default written out, paths absolute.
std::string to_yaml(const Configuration& configuration);

/// Sections that choose one module.
const std::vector<std::string>& choice_sections();

}  // namespace holdfast
