// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <opencv2/core/mat.hpp>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/evaluation/instance_evaluation.hpp"
#include "holdfast/image_files/image_decoder.hpp"
#include "holdfast/image_files/label_map.hpp"

namespace holdfast {

/// Files of a folder by name without extension, those with one of the extensions (".png"). Throws InputError for a
/// folder that is missing or holds none, and for two files of one name.
std::map<std::string, std::filesystem::path> files_by_stem(const std::filesystem::path& folder,
                                                           const std::vector<std::string>& extensions);

/// Label images of a folder, whose values mean what `map` says, such as "{1-254: person, 255: unknown}"; where that is
/// empty, what classes.yaml in the folder says, which `holdfast segment` writes there.
class LabelFolder {
 public:
  /// `option` names the map in messages. Throws InputError when there is no map, ConfigurationError for a wrong one.
  LabelFolder(const std::filesystem::path& folder, const std::string& map, const std::string& option);

  const std::map<std::string, std::filesystem::path>& files() const { return files_; }
  const std::vector<std::string>& classes() const { return map_.classes(); }
  /// Indices into classes(), 255 = unknown. Throws InputError as ImageDecoder and LabelMap do.
  cv::Mat read(const std::filesystem::path& file);
  /// The same and, as an instance, each value of an image that has a class other than background: label images in which
  /// values number objects, such as 3 for the third person.
  std::pair<cv::Mat, InstanceImage> read_instances(const std::filesystem::path& file);

 private:
  std::map<std::string, std::filesystem::path> files_;
  LabelMap map_;
  ImageDecoder decoder_;
};

/// Labels of one list of classes as labels of another: by name; what the other list lacks becomes background, 255
/// stays.
cv::Mat translated(const cv::Mat& labels, const std::vector<std::string>& from, const std::vector<std::string>& to);

}  // namespace holdfast
