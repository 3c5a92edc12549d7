// SPDX-License-Identifier: BSD-3-Clause
#include "run_folders.hpp"

#include <unistd.h>

#include <fstream>
#include <iterator>

namespace holdfast {

std::filesystem::path incomplete_folder(const std::filesystem::path& folder) {
  char host[256] = {};
  gethostname(host, sizeof(host) - 1);
  return folder.parent_path() /
         ("." + folder.filename().string() + incomplete_mark + host + "-" + std::to_string(getpid()));
}

std::string content_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

}  // namespace holdfast
