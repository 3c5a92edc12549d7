// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>

namespace holdfast {

/// Maximum size of a file of each kind [bytes], far above any valid file.
namespace largest_file {
inline constexpr std::uint64_t configuration = std::uint64_t{16} << 20;  ///< YAML: configurations, scenes, cameras
inline constexpr std::uint64_t json = std::uint64_t{512} << 20;
inline constexpr std::uint64_t image = std::uint64_t{1} << 30;
inline constexpr std::uint64_t text = std::uint64_t{4} << 30;  ///< lists and trajectories, which are read line by line
inline constexpr std::uint64_t network = std::uint64_t{4} << 30;
inline constexpr std::uint64_t cloud = std::uint64_t{4} << 30;
inline constexpr std::uint64_t unbounded = std::numeric_limits<std::uint64_t>::max();
}  // namespace largest_file

/// Describes why a file cannot be read, such as "no such file", "found a folder", "found a device, which may never end"
/// or "found more than 16 MiB, the most that is read of such a file"; empty if it seems readable. Devices and named
/// pipes are refused because they may block or never end, except open descriptors such as /dev/stdin and a shell's
/// <(command).
std::string why_unreadable(const std::filesystem::path& file, std::uint64_t most_bytes);

/// A file that is read from its beginning, unbuffered. A failed read throws InputError with the system's reason and is
/// never mistaken for the end of the file. Used by one thread.
class InputFile {
 public:
  /// Opens the file. Throws InputError with the text of why_unreadable() and "; expected EXPECTED".
  InputFile(std::filesystem::path file, std::uint64_t most_bytes, std::string expected);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Size of a regular file when it was opened [bytes]; 0 for other files.
  std::uint64_t size() const { return size_; }
  /// Reads `count` bytes; fewer only at the end of the file. Throws InputError for a read that fails, and for a file
  /// that has more than `most_bytes`.
  std::size_t read(void* into, std::size_t count);
  /// Sets the position of the next read() in a regular file. Throws InputError if the system refuses it.
  void seek(std::uint64_t position);
  /// Reads the rest of the file into a std::string or a std::vector of bytes, and reuses its memory.
  template <class Bytes>
  void read_rest(Bytes& bytes) {
    constexpr std::uint64_t least = 1 << 16;
    std::size_t filled = 0;
    bytes.resize(static_cast<std::size_t>(size_ > position_ ? size_ - position_ + 1 : least));
    while ((filled += read(bytes.data() + filled, bytes.size() - filled)) == bytes.size())
      bytes.resize(filled + std::max<std::size_t>(filled, least));
    bytes.resize(filled);
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const;

  std::filesystem::path path_;
  std::uint64_t most_bytes_;
  std::string expected_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0, position_ = 0;
};

/// The content of a file. Throws as InputFile does.
std::string file_content(const std::filesystem::path& file, std::uint64_t most_bytes, const std::string& expected);

}  // namespace holdfast
