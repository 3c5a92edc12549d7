// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/config/configuration_node.hpp"
#include "holdfast/config/parameter_reader.hpp"
#include "holdfast/config/run_settings.hpp"
#include "holdfast/core/camera.hpp"
#include "holdfast/core/imu.hpp"
#include "holdfast/core/sensor.hpp"
#include "holdfast/core/warning.hpp"
#include "holdfast/plugin/parameter_table.hpp"
#include "holdfast/plugin/registry.hpp"

namespace holdfast {

/// A section of plain parameters that belongs to no module, such as tracking or mapping.
struct SectionDescription {
  std::string name;
  std::string help;
  std::vector<Parameter> parameters;
  std::string kind = "section";  ///< heading that the reference lists it under
};

/// The `camera` section when it is a map: numbers, or a known name and the numbers that differ from it.
struct CameraSettings {
  std::string name;
  int width = 640, height = 480;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;
  double k4 = 0, k5 = 0, k6 = 0;
  std::string lens = "radial_tangential";
  double baseline = 0.08;
  double frame_rate = 30.0;
  double readout = 0.0;

  static void describe(ParameterTable<CameraSettings>& table);
};

CameraSettings camera_settings(const Camera& camera);
Camera make_camera(const CameraSettings& settings);

/// Reads a `camera` section, which is a known name or a map of numbers. Problems are appended to `diagnostics`, and the
/// result is empty then. `elsewhere`: see read_parameters().
std::optional<Camera> read_camera(const ConfigurationNode& node, std::vector<Diagnostic>& diagnostics,
                                  const FindParameter& elsewhere = {});

/// The `imu` section when it is a map: numbers, or a known name and the numbers that differ from it.
struct ImuSettings {
  std::string name;
  std::vector<std::string> kalibr;
  RealTable T_body_camera;  ///< the rows of a 4 x 4 matrix; empty = identity
  double rate = ImuCalibration().rate;
  double time_offset = 0.0;
  double gyroscope_noise_density = ImuNoise().gyroscope_noise_density;
  double accelerometer_noise_density = ImuNoise().accelerometer_noise_density;
  double gyroscope_random_walk = ImuNoise().gyroscope_random_walk;
  double accelerometer_random_walk = ImuNoise().accelerometer_random_walk;
  double gyroscope_range = ImuCalibration().gyroscope_range;
  double accelerometer_range = ImuCalibration().accelerometer_range;

  static void describe(ParameterTable<ImuSettings>& table);
};

ImuSettings imu_settings(const ImuCalibration& calibration);

/// Reads an `imu` section, which is a known name or a map of numbers. Problems are appended to `diagnostics`, and the
/// result is empty then. `elsewhere`: see read_parameters().
std::optional<ImuCalibration> read_imu(const ConfigurationNode& node, std::vector<Diagnostic>& diagnostics,
                                       const FindParameter& elsewhere = {});

/// A module that a configuration selects, with the values of all its parameters, defaults included.
struct ModuleChoice {
  std::string kind;
  std::string name;
  ParameterValues values;
  SourceLocation location;  ///< of the name
};

/// A configuration in which every name is known and every value is in range. The compatibility of the modules (camera,
/// depth, segmentation) is checked by PipelineBuilder, which knows the source.
struct Configuration {
  std::string file;
  ModuleChoice source, features, matcher, segmenter, optimizer, loop_detector;
  std::vector<ModuleChoice> filters;  ///< a chain
  std::vector<ModuleChoice> observers;
  std::optional<Camera> camera;  ///< empty: that of the source
  /// Set by `camera: auto`: the source's own camera takes precedence over `camera`, which follows from the name of its
  /// folder; this is the error if there is neither.
  std::optional<Diagnostic> unknown_camera;
  std::optional<Sensor> sensor;       ///< empty: all images of the source
  std::optional<ImuCalibration> imu;  ///< empty: that of the source, if it has one
  SourceLocation imu_location;        ///< of the section, if there is one
  /// Warnings with their locations, such as a folder that is named after another camera.
  Warnings warnings;
  RunSettings run;
  std::map<std::string, ParameterValues> sections;  ///< values of the plain sections, by name
  std::vector<std::string> plugins;                 ///< absolute paths of the plugin files
};

/// The settings of a plain section. Parameters without a value, and those of a missing section, have their defaults.
template <class Settings>
Settings section_settings(const Configuration& configuration, const std::string& name) {
  const auto section = configuration.sections.find(name);
  return section == configuration.sections.end() ? Settings{} : ParameterTable<Settings>().settings(section->second);
}

/// Reads, overrides and resolves a configuration file with the given plain sections. Plugins that it names are loaded
/// into `registry` first. Throws ConfigurationError with every problem found. load_configuration() of
/// run/configured_pipeline.hpp knows the sections of the pipeline.
Configuration read_configuration(const std::filesystem::path& file, const std::vector<std::string>& overrides,
                                 Registry& registry, const std::vector<SectionDescription>& sections);

/// Resolves a configuration that has been parsed; `file` names it in messages.
Configuration resolve_configuration(const ConfigurationNode& root, const std::string& file, Registry& registry,
                                    const std::vector<SectionDescription>& sections);

/// YAML of the same configuration with all defaults and absolute paths.
std::string to_yaml(const Configuration& configuration);

/// Names of the sections that choose one module.
const std::vector<std::string>& choice_sections();

}  // namespace holdfast
