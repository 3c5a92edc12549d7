// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/plugin/registry.hpp"

namespace holdfast {

/// Registers every plugin that is linked into the program, and the null objects `none` of segmenter and loop_detector.
/// CMake generates the list of plugins. Requires linking holdfast::builtin_plugins.
void register_builtin_plugins(Registry& registry);

}  // namespace holdfast
