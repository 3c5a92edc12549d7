// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "holdfast/core/error.hpp"

namespace holdfast {

/// Thrown for an output folder that holds something and may not be overwritten.
class OutputFolderNotEmpty : public InputError {
 public:
  using InputError::InputError;
};

/// Keeps a folder for one process as long as the object lives: a second one would mix its files with those of the
/// first. The folder itself is locked, so that no file stays behind; the end of the process releases it as well.
class FolderLock {
 public:
  /// Throws InputError when another process holds the folder. Where the file system knows no locks, there is none.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(FolderLock&& other) noexcept;
  FolderLock& operator=(FolderLock&&) = delete;

 private:
  int folder_;
};

/// Makes a folder for results, and keeps it for this process as long as the returned lock lives. One that is not empty
/// is refused (OutputFolderNotEmpty) unless `overwrite`; then only the entries named in `ours` are removed, in this
/// order, with what a killed process left of writing them (NAME.tmp), and what else lies there stays.
[[nodiscard]] FolderLock prepare_output_folder(const std::filesystem::path& folder, bool overwrite,
                                               const std::vector<std::string>& ours);

}  // namespace holdfast
