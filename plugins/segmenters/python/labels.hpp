// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <cstddef>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>

#include "holdfast/interfaces/segmenter.hpp"

namespace holdfast::python_plugin {

/// What segment() of the class `owner` in a file returned, as a segmentation of its own memory: labels, (labels,
/// confidence), (labels, confidence, instances), or None for none. Throws InputError with what was found and expected
/// where it is anything else. The lock must be held.
Segmentation read_result(const pybind11::object& result, const cv::Size& size, std::size_t classes,
                         const std::string& owner, const std::filesystem::path& file);

}  // namespace holdfast::python_plugin
