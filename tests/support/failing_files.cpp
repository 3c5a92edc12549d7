// SPDX-License-Identifier: BSD-3-Clause
// A library for LD_PRELOAD that makes one operation on files fail: the n-th write, rename or fsync below a folder, or
// close of a file that was written there, as if the disk were full at that moment; or the n-th read, as if the disk
// were broken there. It knows five variables of the environment:
//   HOLDFAST_FAIL_FOLDER   the folder, or the beginning of the names of files; without it nothing fails
//   HOLDFAST_FAIL_AT       n, counted from 1 over all threads; 0 fails nothing
//   HOLDFAST_FAIL_READ_AT  the same for reads, which are counted apart
//   HOLDFAST_FAIL_PARENT   a process: only its children are concerned, and not what they start
//   HOLDFAST_FAIL_COUNT    a file outside of the folder that gets the number of operations at the end of the process
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

std::atomic<long> operations = 0, reads = 0;

template <class Function>
Function original(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

bool is_concerned() {
  static const bool result = [] {
    const char* parent = std::getenv("HOLDFAST_FAIL_PARENT");
    return parent != nullptr && std::atol(parent) == static_cast<long>(getppid());
  }();
  return result;
}

bool is_below(const char* path) {
  const char* folder = std::getenv("HOLDFAST_FAIL_FOLDER");
  if (folder == nullptr || !is_concerned()) return false;
  char absolute[2 * PATH_MAX + 2] = "";
  if (path[0] != '/' && getcwd(absolute, PATH_MAX) != nullptr) std::strcat(absolute, "/");
  std::strncat(absolute, path, PATH_MAX);
  return std::strncmp(absolute, folder, std::strlen(folder)) == 0;
}

bool is_below(int descriptor) {
  char link[64], path[PATH_MAX + 1];
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t length = readlink(link, path, PATH_MAX);
  if (length <= 0) return false;
  path[length] = '\0';
  return is_below(path);
}

/// Counts an operation; true if it is the one that fails.
bool fails() {
  const char* at = std::getenv("HOLDFAST_FAIL_AT");
  if (++operations != (at == nullptr ? 0 : std::atol(at))) return false;
  errno = ENOSPC;
  return true;
}

/// The same for reads.
bool read_fails() {
  const char* at = std::getenv("HOLDFAST_FAIL_READ_AT");
  if (at == nullptr || ++reads != std::atol(at)) return false;
  errno = EIO;
  return true;
}

const struct Report {
  ~Report() {
    const char* file = std::getenv("HOLDFAST_FAIL_COUNT");
    if (file == nullptr || !is_concerned()) return;
    char text[32];
    const int length = std::snprintf(text, sizeof text, "%ld\n", operations.load());
    const int descriptor = open(file, O_WRONLY | O_CREAT | O_TRUNC, 0644);
    if (descriptor < 0) return;
    static const auto write_original = original<ssize_t (*)(int, const void*, size_t)>("write");
    [[maybe_unused]] const ssize_t written = write_original(descriptor, text, static_cast<std::size_t>(length));
    close(descriptor);
  }
} report;

}  // namespace

extern "C" {

ssize_t write(int descriptor, const void* data, size_t size) {
  static const auto next = original<ssize_t (*)(int, const void*, size_t)>("write");
  return is_below(descriptor) && fails() ? -1 : next(descriptor, data, size);
}

ssize_t writev(int descriptor, const iovec* parts, int count) {
  static const auto next = original<ssize_t (*)(int, const iovec*, int)>("writev");
  return is_below(descriptor) && fails() ? -1 : next(descriptor, parts, count);
}

size_t fwrite(const void* data, size_t size, size_t count, FILE* stream) {
  static const auto next = original<size_t (*)(const void*, size_t, size_t, FILE*)>("fwrite");
  return is_below(fileno(stream)) && fails() ? 0 : next(data, size, count, stream);
}

int rename(const char* from, const char* to) {
  static const auto next = original<int (*)(const char*, const char*)>("rename");
  return is_below(to) && fails() ? -1 : next(from, to);
}

ssize_t read(int descriptor, void* data, size_t size) {
  static const auto next = original<ssize_t (*)(int, void*, size_t)>("read");
  return is_below(descriptor) && read_fails() ? -1 : next(descriptor, data, size);
}

int close(int descriptor) {
  static const auto next = original<int (*)(int)>("close");
  const int mode = fcntl(descriptor, F_GETFL);
  const bool fails_late = mode >= 0 && (mode & O_ACCMODE) != O_RDONLY && is_below(descriptor) && fails();
  const int error = errno, result = next(descriptor);
  if (fails_late) errno = error;
  return fails_late ? -1 : result;
}

int syncfs(int descriptor) {
  static const auto next = original<int (*)(int)>("syncfs");
  return is_below(descriptor) && fails() ? -1 : next(descriptor);
}

int fsync(int descriptor) {
  static const auto next = original<int (*)(int)>("fsync");
  return is_below(descriptor) && fails() ? -1 : next(descriptor);
}
}
