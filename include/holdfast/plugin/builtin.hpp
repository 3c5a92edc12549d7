// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/plugin/registry.hpp"

namespace holdfast {

/// Registers every plugin that was linked in, and the null objects `none` of segmenter and loop_detector. The list of
/// plugins is generated from what CMake knows. Link holdfast::builtin_plugins.
void register_builtin_plugins(Registry& registry);

}  // namespace holdfast
