// SPDX-License-Identifier: BSD-3-Clause
#include "label_files.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>

#include "holdfast/core/error.hpp"
#include "holdfast/image_files/image_list.hpp"

namespace holdfast::precomputed_plugin {

namespace {

std::optional<double> stamp_of(const std::string& name) {
  double stamp = 0.0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), stamp);
  if (error != std::errc() || end != name.data() + name.size() || !std::isfinite(stamp)) return std::nullopt;
  return stamp;
}

bool is_png(const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  return extension == ".png" || extension == ".PNG";
}

void require_folder(const std::filesystem::path& folder) {
  std::error_code error;
  if (std::filesystem::is_directory(folder, error)) return;
  throw InputError({folder.string()},
                   std::string(std::filesystem::exists(folder, error) ? "is not a folder" : "is missing") +
                       "; expected a folder of label images; set `segmenter.precomputed.path`");
}

}  // namespace

std::vector<LabelFile> find_label_files(const std::filesystem::path& folder) {
  require_folder(folder);
  std::vector<LabelFile> files;
  std::error_code error;
  std::filesystem::directory_iterator entry(folder, error);
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    const std::filesystem::path& path = entry->path();
    if (!is_png(path)) continue;
    const std::optional<double> stamp = stamp_of(path.stem().string());
    if (!stamp)
      throw InputError({path.string()},
                       "has no time stamp as its name; expected names such as 1305031102.175304.png, or a file with "
                       "lines 'timestamp filename' in `segmenter.precomputed.list`");
    files.push_back({*stamp, path});
  }
  if (error) throw InputError({folder.string()}, "cannot be read: " + error.message() + "; check its permissions");
  if (files.empty())
    throw InputError({folder.string()},
                     "holds no label image; expected PNG files; correct `segmenter.precomputed.path`");
  std::sort(files.begin(), files.end(), [](const LabelFile& left, const LabelFile& right) {
    return left.timestamp != right.timestamp ? left.timestamp < right.timestamp : left.path < right.path;
  });
  for (std::size_t i = 1; i < files.size(); ++i)
    if (files[i - 1].timestamp == files[i].timestamp)
      throw InputError({files[i].path.string()}, "has the same time stamp as '" + files[i - 1].path.string() +
                                                     "'; expected one image for each; move one elsewhere");
  return files;
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
