// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "holdfast/config/configuration.hpp"
#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/pipeline/pipeline.hpp"
#include "holdfast/plugin/registry.hpp"

namespace holdfast {

/// The plain sections of a configuration that belong to the pipeline: tracking, mapping. For load_configuration().
std::vector<SectionDescription> pipeline_sections();

/// A source and the pipeline that its frames go into.
struct BuiltPipeline {
  std::unique_ptr<FrameSource> source;
  Pipeline pipeline;
};

/// Makes every module that a configuration chose and checks that they fit together: the camera is known and not
/// told twice differently, filters get what they need. Throws ConfigurationError with all misfits, and what a module
/// throws when it is made. `output_directory` is told to the modules; empty when nothing is written. The registry is
/// not needed afterwards.
BuiltPipeline build_pipeline(const Configuration& configuration, const Registry& registry,
                             const std::filesystem::path& output_directory = {});

}  // namespace holdfast
