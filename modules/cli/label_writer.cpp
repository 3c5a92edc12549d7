// SPDX-License-Identifier: BSD-3-Clause
#include "label_writer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/core/parsed_number.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/plugin/parameter.hpp"
#include "output_folder.hpp"
#include "recording_writer.hpp"

namespace holdfast {

namespace fs = std::filesystem;

namespace {

constexpr const char* classes_name = "classes.yaml";
constexpr const char* list_name = "labels.txt";

bool is_stamp(const std::string& name) { return parsed_number<double>(name).has_value(); }

/// What an earlier run left, the list first.
std::vector<std::string> files_of_earlier_run(const fs::path& folder) {
  std::vector<std::string> names = {list_name};
  if (!fs::exists(folder / classes_name)) {
    if (fs::is_directory(folder) && !fs::is_empty(folder))
      throw InputError({folder.string()}, std::string("the output folder holds something else than label images: no ") +
                                              classes_name + " of an earlier run; name another folder");
    return names;
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if ((entry.path().extension() == ".png" || entry.path().extension() == ".jpg") &&
        is_stamp(entry.path().stem().string()))
      names.push_back(entry.path().filename().string());
  std::sort(names.begin() + 1, names.end());
  names.emplace_back(classes_name);
  return names;
}

/// The values of the images with their meaning: { 0: background, 1: person, 255: unknown }.
std::string meaning_of_values(const std::vector<std::string>& classes) {
  std::string text = "{ ";
  for (std::size_t i = 0; i < classes.size(); ++i)
    text += std::to_string(i) + ": " + to_string(ParameterValue(classes[i])) + ", ";
  return text + "255: unknown }";
}

}  // namespace

LabelWriter::LabelWriter(fs::path folder, std::vector<std::string> classes, bool overwrite)
    : folder_(std::move(folder)),
      classes_(std::move(classes)),
      lock_(prepare_output_folder(folder_, overwrite,
                                  overwrite ? files_of_earlier_run(folder_) : std::vector<std::string>())),
      list_("# label images; classes.yaml says what the values mean\n# timestamp filename\n") {
  write_file_atomically(folder_ / classes_name, "labels: " + meaning_of_values(classes_) + "\n");
}

void LabelWriter::write(double timestamp, const cv::Mat& labels, const cv::Mat& picture) {
  char stamp[400];
  std::snprintf(stamp, sizeof(stamp), "%.6f", timestamp);
  const std::string name = std::string(stamp) + ".png";
  write_image_atomically(folder_ / name, labels);
  if (!picture.empty()) write_image_atomically(folder_ / (std::string(stamp) + ".jpg"), picture);
  list_ += std::string(stamp) + " " + name + "\n";
  stamps_.push_back(timestamp);
}

void LabelWriter::finish() {
  sync_file_system(folder_);
  write_file_atomically(folder_ / list_name, list_);
}

std::string LabelWriter::configuration(bool every_frame) const {
  std::string text = "segmenter:\n  precomputed:\n    path: " +
                     to_string(ParameterValue(fs::absolute(folder_).lexically_normal().string()));
  if (!every_frame && stamps_.size() > 1) {
    double widest = 0.0;
    for (std::size_t i = 1; i < stamps_.size(); ++i) widest = std::max(widest, stamps_[i] - stamps_[i - 1]);
    text += "\n    tolerance: " + to_string(ParameterValue(std::ceil(widest / 2.0 * 1e3) / 1e3));
  }
  return text + "\n    labels: " + meaning_of_values(classes_) + "\n";
}

}  // namespace holdfast
