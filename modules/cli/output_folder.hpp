// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace holdfast {

/// Makes a folder for results. One that is not empty is refused (InputError) unless `overwrite`; then only the entries
/// named in `ours` are removed, in this order, and what else lies there stays.
void prepare_output_folder(const std::filesystem::path& folder, bool overwrite, const std::vector<std::string>& ours);

}  // namespace holdfast
