// SPDX-License-Identifier: BSD-3-Clause
#include "installed_files.hpp"

#include <algorithm>

#include "holdfast/core/error.hpp"
#include "holdfast/plugin/did_you_mean.hpp"
#include "output_file.hpp"

namespace holdfast {

namespace {

namespace fs = std::filesystem;

constexpr const char* ending = ".yaml";

/// Relative to the program, so that an installation can be moved. A build has links there to the files of the sources.
fs::path path_of(InstalledFolder folder) {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error) return {};
  const fs::path data = (program.parent_path() / HOLDFAST_DATA_FROM_PROGRAM).lexically_normal();
  return data / (folder == InstalledFolder::configurations ? "configs" : "scenes");
}

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored) && !fs::is_directory(path, ignored);
}

}  // namespace

std::vector<std::string> installed_names(InstalledFolder folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(path_of(folder), error))
    if (entry.path().extension() == ending) names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string find_file(const std::string& argument, InstalledFolder folder) {
  if (argument.empty() || argument == "-" || argument.find('/') != std::string::npos || is_file(argument))
    return input_name(argument);
  const fs::path file = path_of(folder) / argument;
  for (const fs::path& candidate : {file, fs::path(file.string() + ending)})
    if (candidate.extension() == ending && is_file(candidate)) return candidate.string();
  const std::vector<std::string> names = installed_names(folder);
  if (fs::path(argument).has_extension() || names.empty()) return argument;
  const std::string kind = folder == InstalledFolder::configurations ? "configuration" : "scene";
  throw ConfigurationError(
      SourceLocation{argument},
      "there is no such file, and no " + kind + " of this name is installed; " + did_you_mean(argument, names));
}

}  // namespace holdfast
