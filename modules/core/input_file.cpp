// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/input_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <iterator>
#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/core/system_reason.hpp"

namespace holdfast {

namespace {

namespace fs = std::filesystem;

/// Named descriptors that the system has opened for this program; opening them does not block.
bool is_passed_by_system(const fs::path& file) {
  const std::string name = file.string();
  return name == "/dev/stdin" || name.starts_with("/dev/fd/") || name.starts_with("/proc/self/fd/");
}

std::string binary_size_text(std::uint64_t bytes) {
  constexpr const char* units[] = {" bytes", " KiB", " MiB", " GiB", " TiB"};
  std::size_t unit = 0;
  for (; bytes >= 1024 && bytes % 1024 == 0 && unit + 1 < std::size(units); ++unit) bytes /= 1024;
  return std::to_string(bytes) + units[unit];
}

std::string too_large_text(std::uint64_t most_bytes) {
  return "found more than " + binary_size_text(most_bytes) + ", the most that is read of such a file";
}

/// why_unreadable() of an existing file.
std::string problem_of(const struct stat& status, bool is_passed, std::uint64_t most_bytes) {
  if (S_ISDIR(status.st_mode)) return "found a folder";
  if (S_ISREG(status.st_mode))
    return static_cast<std::uint64_t>(status.st_size) > most_bytes ? too_large_text(most_bytes) : "";
  if (is_passed) return "";
  if (S_ISFIFO(status.st_mode)) return "found a named pipe, which may never end";
  if (S_ISSOCK(status.st_mode)) return "found a socket";
  return "found a device, which may never end";
}

}  // namespace

std::string why_unreadable(const fs::path& file, std::uint64_t most_bytes) {
  struct stat status {};
  if (stat(file.c_str(), &status) == 0) return problem_of(status, is_passed_by_system(file), most_bytes);
  // A name that is too long, or below a file, is no file either.
  if (errno == ENOENT || errno == ENOTDIR || errno == ENAMETOOLONG) return "no such file";
  return "cannot be opened: " + system_reason(errno);
}

InputFile::InputFile(fs::path file, std::uint64_t most_bytes, std::string expected)
    : path_(std::move(file)), most_bytes_(most_bytes), expected_(std::move(expected)) {
  if (const std::string problem = why_unreadable(path_, most_bytes_); !problem.empty()) fail(problem);
  const bool is_passed = is_passed_by_system(path_);
  descriptor_ = open(path_.c_str(), O_RDONLY | O_CLOEXEC | (is_passed ? 0 : O_NONBLOCK));
  if (descriptor_ < 0) fail("cannot be opened: " + system_reason(errno));
  struct stat status {};
  std::string problem;
  if (fstat(descriptor_, &status) != 0)
    problem = "cannot be read: " + system_reason(errno);
  else
    problem = problem_of(status, is_passed, most_bytes_);  // it may be another file by now
  if (!problem.empty()) {
    close(descriptor_);
    fail(problem);
  }
  if (S_ISREG(status.st_mode)) size_ = static_cast<std::uint64_t>(status.st_size);
}

InputFile::~InputFile() { close(descriptor_); }

void InputFile::fail(const std::string& problem) const {
  throw InputError({path_.string()}, problem + "; expected " + expected_);
}

std::size_t InputFile::read(void* into, std::size_t count) {
  std::size_t filled = 0;
  while (filled < count) {
    const ssize_t got = ::read(descriptor_, static_cast<char*>(into) + filled, count - filled);
    if (got == 0) break;
    if (got < 0 && errno == EINTR) continue;
    if (got < 0)
      throw InputError({path_.string()}, "cannot be read beyond byte " + std::to_string(position_ + filled) + ": " +
                                             system_reason(errno) + "; is the disk in order?");
    filled += static_cast<std::size_t>(got);
  }
  position_ += filled;
  if (position_ > most_bytes_) fail(too_large_text(most_bytes_));
  return filled;
}

void InputFile::seek(std::uint64_t position) {
  if (lseek(descriptor_, static_cast<off_t>(position), SEEK_SET) < 0)
    throw InputError({path_.string()},
                     "cannot be read at byte " + std::to_string(position) + ": " + system_reason(errno));
  position_ = position;
}

std::string file_content(const fs::path& file, std::uint64_t most_bytes, const std::string& expected) {
  std::string content;
  InputFile(file, most_bytes, expected).read_rest(content);
  return content;
}

}  // namespace holdfast
