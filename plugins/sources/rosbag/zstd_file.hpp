// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace holdfast::rosbag_plugin {

/// The first bytes of data that zstd compressed.
inline constexpr const char* zstd_magic = "\x28\xb5\x2f\xfd";

/// A file in the folder of temporary files (TMPDIR), removed with this object: on POSIX what has opened it keeps it.
class TemporaryFile {
 public:
  explicit TemporaryFile(std::filesystem::path path) : path_(std::move(path)) {}
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// The content of a file that zstd compressed as a whole (`zstd FILE`, rosbag2 with compression of files). Throws
/// InputError for a damaged or truncated one, for a lack of room, and in a build without zstd.
std::filesystem::path unpack_to_temporary_file(const std::filesystem::path& file);

}  // namespace holdfast::rosbag_plugin
