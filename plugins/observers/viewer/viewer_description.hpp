// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/plugin/registry.hpp"

namespace holdfast::viewer_plugin {

/// What the reference says of the observer, in builds without it, too.
ModuleDescription description();

}  // namespace holdfast::viewer_plugin
