// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/config/missing_file.hpp"

#include <algorithm>
#include <vector>

#include "holdfast/plugin/did_you_mean.hpp"

namespace holdfast {

namespace {

namespace fs = std::filesystem;

/// Names of the files of a folder in the order of the alphabet, so that a tie has the same answer on every machine.
std::vector<std::string> file_names(const fs::path& folder, const fs::path& extension) {
  std::vector<std::string> names;
  std::error_code trouble;
  for (fs::directory_iterator entry(folder, trouble), end; !trouble && entry != end; entry.increment(trouble))
    if (entry->path().extension() == extension) names.push_back(entry->path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

std::string missing_file_text(const fs::path& file, const std::string& kind) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  const std::string text = "there is no such " + kind + ";";
  std::error_code trouble;
  if (!fs::is_directory(folder, trouble)) return text + " its folder is missing too;";
  const auto nearest = nearest_name(file.filename().string(), file_names(folder, file.extension()));
  return nearest ? text + " did you mean '" + *nearest + "'?" : text;
}

}  // namespace holdfast
