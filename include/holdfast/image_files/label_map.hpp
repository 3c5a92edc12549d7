// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "holdfast/plugin/parameter.hpp"

namespace holdfast {

/// Maps the values of label images to classes: class names of values and ranges, `{1-254: person, 255: unknown}`. 0 is
/// the background unless it is mapped. Two names are reserved: `background` is label 0, `unknown` is 255.
class LabelMap {
 public:
  /// Throws ConfigurationError with all errors for a key that is neither a value nor a range, a value above 65535, a
  /// value with two names, an empty name, and more than 254 classes. `where` is the prefix of the messages.
  LabelMap(const TextMap& labels, const std::string& where);

  /// Class names by label: the background, then the others in the order of their first occurrence in the map.
  const std::vector<std::string>& classes() const { return classes_; }
  /// Converts an image of values (8UC1 or 16UC1) to labels (8UC1). Throws InputError with the file, the pixel and the
  /// correction if a value has no name.
  cv::Mat apply(const cv::Mat& values, const std::filesystem::path& file) const;

 private:
  std::vector<std::string> classes_;
  std::vector<std::uint16_t> label_of_value_;  // 65536; no_label for values without a name
};

}  // namespace holdfast
