// SPDX-License-Identifier: BSD-3-Clause
#include "output_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace holdfast {

namespace fs = std::filesystem;

FolderLock::FolderLock(const fs::path& folder) : folder_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (folder_ < 0 || flock(folder_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  close(folder_);
  throw InputError({folder.string()},
                   "another process is writing into this folder; wait for its end, or name another folder");
}

FolderLock::~FolderLock() {
  if (folder_ >= 0) close(folder_);
}

FolderLock::FolderLock(FolderLock&& other) noexcept : folder_(std::exchange(other.folder_, -1)) {}

FolderLock prepare_output_folder(const fs::path& folder, bool overwrite, const std::vector<std::string>& ours) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!fs::is_directory(folder))
    throw InputError({folder.string()}, "the output folder cannot be made" + (error ? ": " + error.message() : ""));
  FolderLock lock(folder);
  if (fs::is_empty(folder)) return lock;
  if (!overwrite)
    throw OutputFolderNotEmpty({folder.string()},
                               "the output folder is not empty; name another one or add --overwrite");
  for (const std::string& name : ours) {
    fs::remove_all(folder / name);
    fs::remove_all(folder / (name + ".tmp"));
  }
  return lock;
}

}  // namespace holdfast
