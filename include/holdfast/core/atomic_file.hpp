// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace holdfast {

/// When a file must be on the disk, so that it survives a loss of power.
enum class Durability {
  now,    ///< when the call returns
  later,  ///< after sync_file_system(); for many files in a short time, such as pictures
};

/// Replaces the content of a file atomically: the file always has its earlier or its complete new content. Bytes are
/// written to a temporary file FILE.tmp in the same folder; commit() synchronises, closes and renames it. Every step is
/// checked, because quotas and network file systems report a full disk late. Without commit() the temporary file is
/// removed. Files that cannot be replaced, such as /dev/null, /dev/stdout or a named pipe, are written directly. All
/// methods throw InputError with the system's reason. Used by one thread.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path file, Durability durability = Durability::now);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::string_view bytes);
  void commit();

 private:
  [[noreturn]] void fail(int error) const;
  void close();

  std::filesystem::path file_, written_;  // written_: the temporary file, or file_ where it is written directly
  Durability durability_;
  int descriptor_ = -1;
  bool is_temporary_there_ = false;
};

/// Replaces the content of a file as AtomicFile does. trajectory.hpp declares the same function for Durability::now.
void write_file_atomically(const std::filesystem::path& file, const std::string& content, Durability durability);

/// Synchronises the file system of this folder with the disk. Throws InputError with the system's reason if a write
/// failed.
void sync_file_system(const std::filesystem::path& folder);

}  // namespace holdfast
