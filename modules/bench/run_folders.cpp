// SPDX-License-Identifier: BSD-3-Clause
#include "run_folders.hpp"

#include <unistd.h>

#include "holdfast/core/input_file.hpp"

namespace holdfast {

std::filesystem::path incomplete_folder(const std::filesystem::path& folder) {
  char host[256] = {};
  gethostname(host, sizeof(host) - 1);
  return folder.parent_path() /
         ("." + folder.filename().string() + incomplete_mark + host + "-" + std::to_string(getpid()));
}

std::string content_of(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return "";
  return file_content(file, largest_file::text, "a file of the bench");
}

}  // namespace holdfast
