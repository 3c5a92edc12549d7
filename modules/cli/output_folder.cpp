// SPDX-License-Identifier: BSD-3-Clause
#include "output_folder.hpp"

#include "holdfast/core/error.hpp"

namespace holdfast {

namespace fs = std::filesystem;

void prepare_output_folder(const fs::path& folder, bool overwrite, const std::vector<std::string>& ours) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!fs::is_directory(folder))
    throw InputError({folder.string()}, "the output folder cannot be made" + (error ? ": " + error.message() : ""));
  if (fs::is_empty(folder)) return;
  if (!overwrite)
    throw InputError({folder.string()}, "the output folder is not empty; name another one or add --overwrite");
  for (const std::string& name : ours) fs::remove_all(folder / name);
}

}  // namespace holdfast
