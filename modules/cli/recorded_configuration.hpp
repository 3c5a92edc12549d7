// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/config/configuration.hpp"
#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/plugin/registry.hpp"

namespace holdfast {

/// A configuration with a recording in the place of its source, for the file beside the recording. Paths are relative
/// to that file, so that both can be moved. `source`: of the frames that are recorded. `module`: the source that reads
/// the recording; its parameters have their defaults. Throws PluginError if the registry does not have it.
Configuration recorded_configuration(const Configuration& original, const Registry& registry,
                                     const SourceDescription& source, const std::string& module);

}  // namespace holdfast
