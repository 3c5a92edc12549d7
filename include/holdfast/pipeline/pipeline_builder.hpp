// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "holdfast/config/configuration.hpp"
#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/interfaces/segmenter.hpp"
#include "holdfast/pipeline/pipeline.hpp"
#include "holdfast/plugin/registry.hpp"

namespace holdfast {

/// The plain sections of a configuration that belong to the pipeline: tracking, mapping, loop_closing. For
/// load_configuration().
std::vector<SectionDescription> pipeline_sections();

/// A source and the pipeline that its frames go into.
struct BuiltPipeline {
  std::unique_ptr<FrameSource> source;
  Pipeline pipeline;
};

/// What a run starts from and leaves behind, beside its configuration.
struct RunOptions {
  std::filesystem::path output_directory;  ///< told to the modules; empty when nothing is written
  std::filesystem::path map_file;          ///< a map to continue, or to localise in; empty = begin a new one
  bool localise_only = false;              ///< find poses in the map and leave it as it is; needs map_file
};

/// Makes every module that a configuration chose and checks that they fit together: the camera is known and not
/// told twice differently, filters get what they need, a map was made with the same camera and places in it can be
/// recognised. Throws ConfigurationError with all misfits, InputError for a map file that cannot be used, and what a
/// module throws when it is made. The registry is not needed afterwards.
BuiltPipeline build_pipeline(const Configuration& configuration, const Registry& registry,
                             const RunOptions& options = {});

/// A source and the segmenter that its frames are given to.
struct BuiltSegmenter {
  std::unique_ptr<FrameSource> source;
  std::unique_ptr<Segmenter> segmenter;
};

/// Makes only these two of what a configuration chose: for `holdfast segment`. Throws as build_pipeline() does, and
/// ConfigurationError when the segmenter is 'none'.
BuiltSegmenter build_segmenter(const Configuration& configuration, const Registry& registry);

}  // namespace holdfast
