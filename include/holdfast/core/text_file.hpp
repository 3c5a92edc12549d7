// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <istream>

namespace holdfast {

/// True for a named pipe: nobody may ever write into it, and reading it would wait for ever. What the system offers
/// below /dev, such as /dev/stdin or a shell's <(command), is open already and does not count.
inline bool is_named_pipe(const std::filesystem::path& file) {
  std::error_code ignored;
  return std::filesystem::is_fifo(file, ignored) && !file.string().starts_with("/dev/");
}

/// Skips the UTF-8 byte-order mark that some editors write at the beginning of a text. To be called before anything is
/// read from a file.
inline void skip_byte_order_mark(std::istream& stream) {
  if (stream.peek() != 0xef) {
    stream.clear();  // peek() has met the end of an empty file, which the caller is to meet itself
    return;
  }
  char mark[3] = {};
  stream.read(mark, 3);
  if (stream.gcount() == 3 && mark[1] == '\xbb' && mark[2] == '\xbf') return;
  stream.clear();
  stream.seekg(0);
}

}  // namespace holdfast
