// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/plugin/registry.hpp"

namespace holdfast::python {

/// The built-in modules, those that Python code has registered until now, and the source `fed_frames`. The lock must be
/// held.
Registry make_registry();

}  // namespace holdfast::python
