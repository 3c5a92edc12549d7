// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace holdfast {

/// Explains that `file` is not there: "there is no such scene file; did you mean 'walking_xyz.yaml'?" for the `kind`
/// "scene file". The suggestion is the file of its folder with the most similar name and the same extension, and is
/// left out where none resembles it. A folder that is missing as well is named instead. Never throws what the file
/// system says.
std::string missing_file_text(const std::filesystem::path& file, const std::string& kind);

}  // namespace holdfast
