// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace holdfast {

/// The numbers in a file name, in their order, without leading zeros: {"12"} for left_0012.png.
using FileNumbers = std::vector<std::string>;

/// A file by the numbers in its name.
struct NumberedFile {
  FileNumbers numbers;
  std::filesystem::path path;
};

/// A file name pattern with one number: "colour/%06d.png" (%d: without leading zeros).
class NumberPattern {
 public:
  /// Throws InputError for a pattern without exactly one %d or %0Nd.
  NumberPattern(const std::filesystem::path& folder, const std::string& pattern);

  /// Every file from the lowest to the highest number that exists; a number in between that does not exist is listed
  /// too (it is missing). Throws InputError when there is none.
  std::vector<NumberedFile> find() const;
  std::filesystem::path path_of(const std::string& number) const;

  static bool is_pattern(const std::string& text) { return text.find('%') != std::string::npos; }

 private:
  std::filesystem::path whole_;  ///< folder and pattern, for messages
  std::filesystem::path folder_;
  std::string prefix_, suffix_;  ///< of the file name
  std::size_t digits_ = 0;       ///< at least so many
};

/// The PNG and JPEG files of a folder by the numbers in their names, in natural order (9 before 10); other files are
/// ignored. Throws InputError for a folder that is missing or has no image, a name without a number, and two names with
/// the same numbers.
std::vector<NumberedFile> find_numbered_files(const std::filesystem::path& folder);
/// The same for files with that extension (".txt") in place of images.
std::vector<NumberedFile> find_numbered_files(const std::filesystem::path& folder, const std::string& extension);

/// The numbers in a file name without its extension.
FileNumbers numbers_of(const std::string& name);

/// For each of `files`, the image with the same numbers in another folder, for instance of a second camera. A missing
/// image gets its expected name, with the given `extension` (empty = that of the file), so that reading its frame
/// reports the error. Throws as find_numbered_files() for the folder.
std::vector<std::filesystem::path> find_partners(const std::vector<NumberedFile>& files,
                                                 const std::filesystem::path& folder,
                                                 const std::string& extension = "");

/// Natural order: compares numbers by value.
bool comes_before(const FileNumbers& left, const FileNumbers& right);

}  // namespace holdfast
