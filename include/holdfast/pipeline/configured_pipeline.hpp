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

/// The plain sections of a configuration that belong to the pipeline, in the order of the reference: tracking,
/// segmentation, evidence, mapping, loop_closing, dense_map.
std::vector<SectionDescription> pipeline_sections();

/// Loads a configuration file. Each override has the form "key.path=value" and counts as if the file contained it.
/// Plugins that the configuration names are loaded into `registry`. Throws ConfigurationError with every problem found,
/// each with file:line:column.
Configuration load_configuration(const std::filesystem::path& file, const std::vector<std::string>& overrides,
                                 Registry& registry);
/// Loads a configuration file that may name the built-in modules and those of its own plugins. Link holdfast::holdfast.
inline Configuration load_configuration(const std::filesystem::path& file,
                                        const std::vector<std::string>& overrides = {}) {
  Registry registry;
  register_builtin_plugins(registry);
  return load_configuration(file, overrides, registry);
}

/// Loads the plugins that a configuration names into `registry`. Throws PluginError as load_plugin() does.
void load_plugins(const Configuration& configuration, Registry& registry);

/// Properties of a run that its configuration does not contain.
struct PipelineOptions {
  std::filesystem::path output_directory;  ///< given to the modules; empty when nothing is written
  std::filesystem::path map_file;          ///< map to continue, or to localise in; empty = begin a new map
  bool localise_only = false;              ///< find poses in the map and leave it unchanged; needs map_file
};

/// A source and the pipeline that its frames go into.
struct BuiltPipeline {
  std::unique_ptr<FrameSource> source;
  Pipeline pipeline;

  /// Suspicions of the source and of the pipeline: before the first frame those about files and settings, after
  /// Pipeline::finish() those about the frames as well.
  Warnings warnings() const;
};

/// Makes every module that a configuration selects, by a PipelineBuilder, which checks that they fit together. Throws
/// ConfigurationError with every misfit, InputError for a map file that cannot be used, and any exception of a module's
/// constructor. The registry is not needed afterwards.
BuiltPipeline build_pipeline(const Configuration& configuration, const Registry& registry,
                             const PipelineOptions& options = {});
/// Makes the pipeline from the built-in modules and those of the configuration's plugins. Link holdfast::holdfast.
inline BuiltPipeline build_pipeline(const Configuration& configuration, const PipelineOptions& options = {}) {
  Registry registry;
  register_builtin_plugins(registry);
  load_plugins(configuration, registry);
  return build_pipeline(configuration, registry, options);
}

/// Makes the source of a configuration and nothing else. Throws any exception of its constructor.
std::unique_ptr<FrameSource> build_source(const Configuration& configuration, const Registry& registry);

/// A source and the segmenter that its frames are given to.
struct BuiltSegmenter {
  std::unique_ptr<FrameSource> source;
  std::unique_ptr<Segmenter> segmenter;
};

/// Makes the source and the segmenter of a configuration and nothing else. Throws as build_pipeline() does, and
/// ConfigurationError when the segmenter is 'none'.
BuiltSegmenter build_segmenter(const Configuration& configuration, const Registry& registry);

}  // namespace holdfast
