// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace holdfast {

/// The last component of a path, for titles and names of recordings: "fr1_xyz" for "data/fr1_xyz/".
inline std::string folder_name(const std::filesystem::path& path) {
  const std::filesystem::path folder = std::filesystem::absolute(path).lexically_normal();
  return (folder.has_filename() ? folder : folder.parent_path()).filename().string();
}

}  // namespace holdfast
