// SPDX-License-Identifier: BSD-3-Clause
#include "label_files.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/image_files/image_list.hpp"

namespace holdfast::precomputed_plugin {

namespace {

bool is_png(const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  return extension == ".png" || extension == ".PNG";
}

/// The file by the stamp in its name; nothing if there is none.
std::optional<LabelFile> file_of(const std::filesystem::path& path) {
  const std::string stem = path.stem().string();
  const std::size_t end = stem.find('_');
  const std::optional<double> stamp = stamp_of(stem.substr(0, end));
  if (!stamp) return std::nullopt;
  return LabelFile{*stamp, path, end != std::string::npos};
}

/// Joins the files of instances of a moment.
std::vector<LabelFile> joined_instances(const std::vector<LabelFile>& files) {
  std::vector<LabelFile> result;
  for (const LabelFile& file : files) {
    if (result.empty() || result.back().timestamp != file.timestamp) {
      result.push_back(file);
      continue;
    }
    LabelFile& first = result.back();
    if (!file.is_of_instance || !first.is_of_instance)
      throw InputError({file.path.string()}, "has the same time stamp as '" + first.path.string() +
                                                 "'; expected one image for each, or one for each instance, such as "
                                                 "STAMP_1.png and STAMP_2.png; move one elsewhere");
    first.others.push_back(file.path);
  }
  return result;
}

void require_folder(const std::filesystem::path& folder) {
  std::error_code error;
  if (std::filesystem::is_directory(folder, error)) return;
  throw InputError({folder.string()},
                   std::string(std::filesystem::exists(folder, error) ? "is not a folder" : "is missing") +
                       "; expected a folder of label images; set `segmenter.precomputed.path`");
}

}  // namespace

std::optional<double> stamp_of(const std::string& name) {
  double stamp = 0.0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), stamp);
  if (error != std::errc() || end != name.data() + name.size() || !std::isfinite(stamp)) return std::nullopt;
  return stamp;
}

bool is_array(const std::filesystem::path& file) { return file.extension() == ".npy" || file.extension() == ".npz"; }

std::vector<LabelFile> find_label_files(const std::filesystem::path& folder) {
  require_folder(folder);
  std::vector<LabelFile> files;
  std::error_code error;
  std::filesystem::directory_iterator entry(folder, error);
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    const std::filesystem::path& path = entry->path();
    if (!is_png(path) && !is_array(path)) continue;
    std::optional<LabelFile> file = file_of(path);
    if (!file)
      throw InputError({path.string()},
                       "has no time stamp as its name; expected names such as 1305031102.175304.png, or a file with "
                       "lines 'timestamp filename' in `segmenter.precomputed.list`");
    files.push_back(std::move(*file));
  }
  if (error) throw InputError({folder.string()}, "cannot be read: " + error.message() + "; check its permissions");
  if (files.empty())
    throw InputError({folder.string()},
                     "holds no label image; expected PNG, NPY or NPZ files; correct `segmenter.precomputed.path`");
  std::sort(files.begin(), files.end(), [](const LabelFile& left, const LabelFile& right) {
    return left.timestamp != right.timestamp ? left.timestamp < right.timestamp : left.path < right.path;
  });
  return joined_instances(files);
}

std::vector<LabelFile> listed_label_files(const std::filesystem::path& folder, const std::filesystem::path& list) {
  require_folder(folder);
  std::vector<LabelFile> files;
  for (const ListedImage& image : read_image_list(list)) files.push_back({image.timestamp, folder / image.name});
  return files;
}

const LabelFile* nearest_label_file(const std::vector<LabelFile>& files, double timestamp, double tolerance) {
  const auto later = std::lower_bound(files.begin(), files.end(), timestamp,
                                      [](const LabelFile& file, double stamp) { return file.timestamp < stamp; });
  const LabelFile* best = later == files.end() ? nullptr : &*later;
  if (later != files.begin()) {
    const LabelFile& earlier = *(later - 1);
    if (best == nullptr || timestamp - earlier.timestamp <= best->timestamp - timestamp) best = &earlier;
  }
  return best != nullptr && std::abs(best->timestamp - timestamp) <= tolerance ? best : nullptr;
}

}  // namespace holdfast::precomputed_plugin
