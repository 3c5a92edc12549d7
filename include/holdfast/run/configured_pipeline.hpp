// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "holdfast/config/configuration.hpp"
#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/interfaces/segmenter.hpp"
#include "holdfast/pipeline/pipeline.hpp"
#include "holdfast/plugin/builtin.hpp"
#include "holdfast/plugin/registry.hpp"

namespace holdfast {

/// The plain sections of a configuration in the order of the reference: those of the pipeline, and `perturbation` of
/// its source.
std::vector<SectionDescription> pipeline_sections();

/// Loads a configuration file. Each override "key.path=value" has the effect of an edit of the file. Plugins named by
/// the configuration are loaded into `registry`. Throws ConfigurationError with all errors found, each with
/// file:line:column.
Configuration load_configuration(const std::filesystem::path& file, const std::vector<std::string>& overrides,
                                 Registry& registry);
/// Loads a configuration file with the built-in modules and those of its plugins. Requires the library
/// holdfast::holdfast.
inline Configuration load_configuration(const std::filesystem::path& file,
                                        const std::vector<std::string>& overrides = {}) {
  Registry registry;
  register_builtin_plugins(registry);
  return load_configuration(file, overrides, registry);
}

/// Loads the plugins of a configuration into `registry`. Throws PluginError as load_plugin() does.
void load_plugins(const Configuration& configuration, Registry& registry);

/// Options of a run that are not part of its configuration.
struct PipelineOptions {
  std::filesystem::path output_directory;  ///< output folder of the modules; empty if nothing is written
  std::filesystem::path map_file;          ///< map to continue, or to localise in; empty = begin a new map
  bool localise_only = false;              ///< localisation in the map without changing it; requires map_file
};

/// A source and the pipeline that processes its frames.
struct BuiltPipeline {
  std::unique_ptr<FrameSource> source;
  Pipeline pipeline;

  /// Warnings of the source and of the pipeline: before the first frame about files and settings, after
  /// Pipeline::finish() about frames as well.
  Warnings warnings() const;
};

/// Constructs the modules of a configuration and the pipeline by a PipelineBuilder. The section `perturbation` acts on
/// the frames and on the camera of BuiltPipeline::source, not on frames from elsewhere. Throws ConfigurationError with
/// all incompatibilities found, InputError for an unusable map file, and any exception of a module's constructor. The
/// registry is not needed afterwards.
BuiltPipeline build_pipeline(const Configuration& configuration, const Registry& registry,
                             const PipelineOptions& options = {});
/// Builds the pipeline with the built-in modules and those of the configuration's plugins. Requires the library
/// holdfast::holdfast.
inline BuiltPipeline build_pipeline(const Configuration& configuration, const PipelineOptions& options = {}) {
  Registry registry;
  register_builtin_plugins(registry);
  load_plugins(configuration, registry);
  return build_pipeline(configuration, registry, options);
}

/// Constructs only the source of a configuration, with its perturbation. Throws any exception of its constructor.
std::unique_ptr<FrameSource> build_source(const Configuration& configuration, const Registry& registry);

/// A source and the segmenter for its frames.
struct BuiltSegmenter {
  std::unique_ptr<FrameSource> source;
  std::unique_ptr<Segmenter> segmenter;
};

/// Constructs only the source and the segmenter of a configuration. Throws as build_pipeline() does, and
/// ConfigurationError if the segmenter is 'none'.
BuiltSegmenter build_segmenter(const Configuration& configuration, const Registry& registry);

}  // namespace holdfast
