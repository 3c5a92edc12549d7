// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <string>

namespace holdfast::python_plugin {

/// Turns what Python raised into an InputError at the line of the user's file that it came through: what was being
/// done, the exception, what was expected, and Python's own traceback. The lock must be held.
[[noreturn]] void throw_python_error(const pybind11::error_already_set& raised, const std::filesystem::path& file,
                                     const std::string& doing, const std::string& expected);

}  // namespace holdfast::python_plugin
