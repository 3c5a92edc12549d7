// SPDX-License-Identifier: BSD-3-Clause
#include "label_folder.hpp"

#include <algorithm>
#include <cstdint>
#include <opencv2/core.hpp>

#include "holdfast/config/configuration_node.hpp"
#include "holdfast/core/cell_mask.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/plugin/parameter.hpp"

namespace holdfast {

namespace fs = std::filesystem;

namespace {

std::string comma_separated(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

TextMap text_map(const ConfigurationNode& node, const std::string& where) {
  using Kind = ConfigurationNode::Kind;
  TextMap map;
  const auto refuse = [&](const std::string& found) {
    throw ConfigurationError(SourceLocation{}, where + ": found " + found +
                                                   "; expected values and the names of their classes, such as "
                                                   "'{1-254: person, 255: unknown}'");
  };
  if (node.kind != Kind::map) refuse(node.found());
  for (const ConfigurationNode::Entry& entry : node.entries) {
    if (entry.value.kind != Kind::scalar) refuse(entry.value.found() + " for '" + entry.key + "'");
    map.emplace_back(entry.key, entry.value.text);
  }
  return map;
}

/// What the option says, or else what lies in the folder.
LabelMap labels_of_map(const fs::path& folder, const std::string& map, const std::string& option) {
  if (!map.empty()) return {text_map(parse_yaml(map, option, folder), option), option};
  const fs::path file = folder / "classes.yaml";
  if (!fs::exists(file))
    throw InputError({folder.string()},
                     "has no classes.yaml that says what the values of the labels mean; say it with " + option +
                         ", such as " + option + " '{1-254: person, 255: unknown}'");
  const ConfigurationNode root = read_yaml(file);
  const ConfigurationNode* labels = root.find("labels");
  if (labels == nullptr)
    throw InputError({file.string()}, "has no 'labels'; expected the file that `holdfast segment` writes");
  return {text_map(*labels, file.string()), file.string()};
}

}  // namespace

std::map<std::string, fs::path> files_by_stem(const fs::path& folder, const std::vector<std::string>& extensions) {
  std::error_code error;
  if (!fs::is_directory(folder, error))
    throw InputError({folder.string()}, std::string(fs::exists(folder, error) ? "is not a folder" : "is missing") +
                                            "; expected a folder of images");
  std::map<std::string, fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const fs::path& path = entry.path();
    if (std::find(extensions.begin(), extensions.end(), path.extension().string()) == extensions.end()) continue;
    const auto [other, is_new] = files.emplace(path.stem().string(), path);
    if (!is_new)
      throw InputError({path.string()}, "has the name of '" + other->second.filename().string() +
                                            "'; expected one image for each name; move one elsewhere");
  }
  if (files.empty())
    throw InputError({folder.string()},
                     "holds no image; expected files with the ending " + comma_separated(extensions));
  return files;
}

LabelFolder::LabelFolder(const fs::path& folder, const std::string& map, const std::string& option)
    : files_(files_by_stem(folder, {".png"})), map_(labels_of_map(folder, map, option)) {}

cv::Mat LabelFolder::read(const fs::path& file) { return map_.apply(decoder_.read_labels(file), file); }

std::pair<cv::Mat, InstanceImage> LabelFolder::read_instances(const fs::path& file) {
  const cv::Mat values = decoder_.read_labels(file), labels = map_.apply(values, file);
  const bool is_wide = values.depth() == CV_16U;
  InstanceImage image{cv::Mat::zeros(values.size(), CV_16UC1), {}};
  std::vector<std::uint16_t> number(65536, 0);
  for (int y = 0; y < values.rows; ++y)
    for (int x = 0; x < values.cols; ++x) {
      const std::uint8_t label = labels.at<std::uint8_t>(y, x);
      if (!CellMask::is_object(label)) continue;
      const std::size_t value = is_wide ? values.at<std::uint16_t>(y, x) : values.at<std::uint8_t>(y, x);
      if (number[value] == 0) {
        image.entries.push_back({label, 1.0F});
        number[value] = static_cast<std::uint16_t>(image.entries.size());
      }
      image.instances.at<std::uint16_t>(y, x) = number[value];
    }
  return {labels, image};
}

cv::Mat translated(const cv::Mat& labels, const std::vector<std::string>& from, const std::vector<std::string>& to) {
  cv::Mat table = cv::Mat::zeros(1, 256, CV_8UC1);
  table.at<std::uint8_t>(255) = 255;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const auto place = std::find(to.begin(), to.end(), from[i]);
    if (place != to.end()) table.at<std::uint8_t>(static_cast<int>(i)) = static_cast<std::uint8_t>(place - to.begin());
  }
  cv::Mat result;
  cv::LUT(labels, table, result);
  return result;
}

}  // namespace holdfast
