// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/core/input_file.hpp"

namespace holdfast {

/// Reads a text file line by line, without a UTF-8 byte-order mark. Read errors in the middle of a file are reported.
/// Used by one thread.
class LineReader {
 public:
  static constexpr std::size_t longest_line = 1 << 20;  ///< [bytes]

  /// Opens the file. Throws as InputFile does.
  LineReader(const std::filesystem::path& file, const std::string& expected,
             std::uint64_t most_bytes = largest_file::text);

  /// Reads the next line without its line feed; false after the last one. Throws InputError for a failed read and for a
  /// line longer than longest_line.
  bool next(std::string& line);
  /// Number of the last line, from 1.
  int number() const { return number_; }
  /// Location of that line, for errors.
  SourceLocation location() const { return {file_.path().string(), number_}; }

 private:
  bool fill();

  InputFile file_;
  std::string expected_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;  // unread part of the buffer
  int number_ = 0;
};

}  // namespace holdfast
