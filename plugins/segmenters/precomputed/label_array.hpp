// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace holdfast::precomputed_plugin {

/// The images of an array: labels of height x width, or masks of instances x height x width.
struct LabelArray {
  std::vector<cv::Mat> images;  ///< 16UC1
  bool is_of_instances = false;
};

/// Reads an array that numpy.save() wrote, or numpy.savez() (seek_label_array()), of boolean or whole numbers from 0 to
/// 65535; true = 1. Throws InputError, which states what was found and what was expected, for other files, types,
/// orders and numbers of dimensions, and for values out of range.
LabelArray read_label_array(const std::filesystem::path& file);

}  // namespace holdfast::precomputed_plugin
