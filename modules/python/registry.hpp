// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include "holdfast/plugin/registry.hpp"

namespace holdfast::python {

/// The built-in modules, those that Python code has registered until now, the source `fed_frames`, and modules that are
/// given as objects: each is (kind, name, file of its class, object). The lock must be held.
Registry make_registry(const pybind11::list& given = pybind11::list());
/// Adds the modules that Python code has registered until now. The lock must be held.
void add_registered(Registry& registry);

}  // namespace holdfast::python
