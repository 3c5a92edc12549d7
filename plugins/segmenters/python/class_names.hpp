// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <string>
#include <vector>

/// Class names of a segmenter in Python. `owner` names its class and `file` the file of that, for messages. The lock
/// must be held.
namespace holdfast::python_plugin {

/// The attribute `classes`: 1 to 255 different names by label. Throws InputError for anything else.
std::vector<std::string> read_classes(const pybind11::object& segmenter, const std::string& owner,
                                      const std::filesystem::path& file);
/// The attribute `movable`, a subset of the classes; empty where there is none. Throws InputError for anything else.
std::vector<std::string> read_movable(const pybind11::object& segmenter, const std::string& owner,
                                      const std::vector<std::string>& classes, const std::filesystem::path& file);

}  // namespace holdfast::python_plugin
