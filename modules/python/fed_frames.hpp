// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/config/configuration_node.hpp"
#include "holdfast/plugin/registry.hpp"

/// The source `fed_frames`: it has no frames, because Python code feeds them. It stands where a configuration must have
/// a source, and says what the builder asks of one.
namespace holdfast::python {

/// Name of the source in a configuration.
inline constexpr const char* fed_frames = "fed_frames";

/// Registers the source.
void register_fed_frames(Registry& registry);
/// Replaces the source of a configuration by `fed_frames`, unless it is that one already, with its parameters.
void feed_from_caller(ConfigurationNode& root);

}  // namespace holdfast::python
