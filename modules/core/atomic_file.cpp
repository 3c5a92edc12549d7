// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <system_error>
#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/core/system_reason.hpp"
#include "holdfast/core/trajectory.hpp"

namespace holdfast {

namespace {

namespace fs = std::filesystem;

const char* remedy(int error) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return "; make room, or name another folder";
    case EFBIG:
      return "; raise the limit of the size of files (ulimit -f)";
    case ENOENT:
    case ENOTDIR:
      return "; is the folder there?";
    case EACCES:
    case EPERM:
    case EROFS:
      return "; name a folder in which you may write";
    default:
      return "; is the disk in order?";
  }
}

/// Whether a file must be written directly, because renaming would replace a device or pipe by a file.
bool is_written_directly(const fs::path& file) {
  const std::string name = file.string();
  if (name == "/dev/stdout" || name == "/dev/stderr" || name.starts_with("/dev/fd/") ||
      name.starts_with("/proc/self/fd/"))
    return true;
  struct stat status {};
  return stat(file.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode);
}

/// False if the system could not synchronise a file or folder. Some file systems report that they do not support it.
bool reaches_disk(int descriptor) {
  return fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP || errno == ENOSYS || errno == EROFS;
}

int open_folder(const fs::path& folder) {
  return open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
}

/// Synchronises the entries of a folder, so that a renamed file keeps its name. A folder without read permission cannot
/// be opened for that.
void sync_folder(const fs::path& folder) {
  const int descriptor = open_folder(folder);
  if (descriptor < 0) return;
  const int error = reaches_disk(descriptor) ? 0 : errno;
  ::close(descriptor);
  if (error != 0)
    throw InputError({folder.string()},
                     "files in this folder cannot be brought to the disk: " + system_reason(error) + remedy(error));
}

}  // namespace

AtomicFile::AtomicFile(fs::path file, Durability durability)
    : file_(std::move(file)), written_(file_), durability_(durability) {
  const bool directly = is_written_directly(file_);
  if (!directly) written_ += ".tmp";
  descriptor_ =
      open(written_.c_str(), O_WRONLY | O_CLOEXEC | (directly ? O_APPEND : O_CREAT | O_TRUNC | O_NONBLOCK), 0666);
  if (descriptor_ < 0) fail(errno);
  is_temporary_there_ = !directly;
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  std::error_code ignored;
  if (is_temporary_there_) fs::remove(written_, ignored);
}

void AtomicFile::fail(int error) const {
  throw InputError({file_.string()}, "cannot be written: " + system_reason(error) + remedy(error));
}

void AtomicFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(errno);
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

void AtomicFile::close() {
  // close() releases the descriptor in any case; an interrupted one is no known loss of data.
  if (::close(std::exchange(descriptor_, -1)) != 0 && errno != EINTR) fail(errno);
}

void AtomicFile::commit() {
  const bool syncs = is_temporary_there_ && durability_ == Durability::now;
  if (syncs && !reaches_disk(descriptor_)) fail(errno);
  close();
  if (!is_temporary_there_) return;
  std::error_code error;
  fs::rename(written_, file_, error);
  if (error) throw InputError({file_.string()}, "cannot be replaced: " + error.message());
  is_temporary_there_ = false;
  if (syncs) sync_folder(file_.parent_path());
}

void write_file_atomically(const fs::path& file, const std::string& content, Durability durability) {
  AtomicFile written(file, durability);
  written.write(content);
  written.commit();
}

void write_file_atomically(const fs::path& file, const std::string& content) {
  write_file_atomically(file, content, Durability::now);
}

void sync_file_system(const fs::path& folder) {
  const int descriptor = open_folder(folder);
  if (descriptor < 0) return;  // a folder that may be written to, and not read
  const int error = syncfs(descriptor) == 0 || errno == ENOSYS ? 0 : errno;
  ::close(descriptor);
  if (error != 0)
    throw InputError({folder.string()},
                     "files in this folder cannot be brought to the disk: " + system_reason(error) + remedy(error));
}

}  // namespace holdfast
