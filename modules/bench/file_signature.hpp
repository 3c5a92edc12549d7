// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "holdfast/core/input_file.hpp"

namespace holdfast {

/// The bytes by which files of a format are recognised.
struct FileSignature {
  const char* format;
  std::size_t offset;  ///< from the beginning of the file
  std::string_view bytes;
};

/// The magic number 20000630 ("OpenEXR File Layout", openexr.com), and the first box (ISO/IEC 14496-12, 4.3).
inline constexpr FileSignature exr_signature = {"OpenEXR image", 0, std::string_view("\x76\x2f\x31\x01", 4)};
inline constexpr FileSignature mp4_signature = {"MP4 video", 4, "ftyp"};

/// Whether a file begins as one of a format does. Throws InputError for a file that cannot be read.
inline bool has_signature(const std::filesystem::path& file, const FileSignature& signature) {
  InputFile input(file, largest_file::unbounded, signature.format);
  std::string begin(signature.offset + signature.bytes.size(), '\0');
  begin.resize(input.read(begin.data(), begin.size()));
  return begin.ends_with(signature.bytes) && begin.size() == signature.offset + signature.bytes.size();
}

}  // namespace holdfast
