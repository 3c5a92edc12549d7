// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

/// The parts of the extension holdfast._core, one per file. It is private: the package holdfast around it is what users
/// see, with its documentation and types.
namespace holdfast::python {

void bind_cameras(pybind11::module_& module);
void bind_frames(pybind11::module_& module);
void bind_trajectories(pybind11::module_& module);
void bind_configurations(pybind11::module_& module);
void bind_maps(pybind11::module_& module);
void bind_results(pybind11::module_& module);
void bind_pipeline(pybind11::module_& module);
void bind_run(pybind11::module_& module);
void bind_simulation(pybind11::module_& module);
void bind_program(pybind11::module_& module);
void bind_modules(pybind11::module_& module);
void bind_filter_context(pybind11::module_& module);

}  // namespace holdfast::python
