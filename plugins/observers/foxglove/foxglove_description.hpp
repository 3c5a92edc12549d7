// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/plugin/registry.hpp"

namespace holdfast::foxglove_plugin {

/// Name and summary, in builds with and without Boost.
ModuleDescription description();

}  // namespace holdfast::foxglove_plugin
