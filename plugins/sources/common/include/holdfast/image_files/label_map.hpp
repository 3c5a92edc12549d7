// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "holdfast/plugin/parameter.hpp"

namespace holdfast {

/// What the values of label images mean: values and ranges of values by class name, `{1-254: person, 255: unknown}`.
/// 0 is the background unless the map says otherwise. Two names are reserved: `background` is label 0, `unknown` 255.
class LabelMap {
 public:
  /// Throws ConfigurationError, all problems at once, for a key that is no value and no range, a value above 65535,
  /// values that are named twice, names that are empty, and more than 254 classes. `where` begins their messages.
  LabelMap(const TextMap& labels, const std::string& where);

  /// By label: the background, then the others in the order in which the map first names them.
  const std::vector<std::string>& classes() const { return classes_; }
  /// Labels (8UC1) of an image of values (8UC1 or 16UC1). Throws InputError naming the file, the pixel and what to
  /// write when a value has no name.
  cv::Mat apply(const cv::Mat& values, const std::filesystem::path& file) const;

 private:
  std::vector<std::string> classes_;
  std::vector<std::uint16_t> label_of_value_;  // 65536; no_label where nothing was said
};

}  // namespace holdfast
