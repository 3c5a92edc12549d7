// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string_view>

namespace holdfast {

/// A text file of the repository that the build embeds in the program (cmake/HoldfastEmbed.cmake). A generated function
/// `std::span<const EmbeddedFile> embedded_NAME()` returns the files of one group.
struct EmbeddedFile {
  std::string_view name;  ///< file name without its folder
  std::string_view content;
};

}  // namespace holdfast
