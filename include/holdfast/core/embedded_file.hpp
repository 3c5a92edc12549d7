// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string_view>

namespace holdfast {

/// A text file of the repository that the build put into the program (cmake/HoldfastEmbed.cmake). Functions
/// `std::span<const EmbeddedFile> embedded_NAME()` give those that belong together.
struct EmbeddedFile {
  std::string_view name;  ///< without folders
  std::string_view content;
};

}  // namespace holdfast
