// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace holdfast {

/// Part of the name of a hidden folder whose content is not complete yet.
inline constexpr const char* incomplete_mark = ".incomplete-";

/// The hidden folder beside `folder` in which this process of this host works until its content is complete. Processes
/// of several nodes may have the same number.
std::filesystem::path incomplete_folder(const std::filesystem::path& folder);

/// The bytes of a file; empty if it cannot be read.
std::string content_of(const std::filesystem::path& file);

}  // namespace holdfast
