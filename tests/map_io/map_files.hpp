// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "crc32c.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/map_io/map_file.hpp"
#include "map_io/random_map.hpp"

namespace holdfast::test {

template <class T>
T number_at(const std::string& bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}
template <class T>
void put_at(std::string& bytes, std::size_t offset, T value) {
  std::memcpy(bytes.data() + offset, &value, sizeof(T));
}

/// Makes all checksums fit again after a change, as far as the lengths allow.
inline void repair_checksums(std::string& bytes) {
  const auto header = number_at<std::uint32_t>(bytes, 12);
  put_at(bytes, header - 4, map_io::crc32c(bytes.data(), header - 4));
  for (std::size_t begin = header; begin + 24 <= bytes.size();) {
    const auto length = number_at<std::uint64_t>(bytes, begin + 8);
    if (length > bytes.size() - begin - 24) return;
    put_at(bytes, begin + 16, map_io::crc32c(bytes.data() + begin + 24, length));
    put_at(bytes, begin + 20, map_io::crc32c(bytes.data() + begin, 20));
    begin += 24 + length;
  }
}

/// Where the n-th section of a type begins.
inline std::size_t find_section(const std::string& bytes, const std::string& type, int n = 0) {
  for (std::size_t begin = number_at<std::uint32_t>(bytes, 12); begin + 24 <= bytes.size();) {
    if (bytes.compare(begin, 4, type) == 0 && n-- == 0) return begin;
    begin += 24 + number_at<std::uint64_t>(bytes, begin + 8);
  }
  ADD_FAILURE() << "no section " << type;
  return 0;
}

/// A folder that goes with the test, and files in it.
class MapFileTest : public ::testing::Test {
 protected:
  MapFileTest() {
    std::string name = (std::filesystem::temp_directory_path() / "holdfast_map_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~MapFileTest() override {
    std::error_code ignored;
    std::filesystem::permissions(folder_, std::filesystem::perms::owner_all, ignored);
    std::filesystem::remove_all(folder_, ignored);
  }

  std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  static std::string content(const std::filesystem::path& file) {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
  }
  void write(const std::string& name, const std::string& bytes) const {
    std::filesystem::remove(path(name));  // some file systems wait for the disk when a file is cut short and refilled
    std::ofstream(path(name), std::ios::binary) << bytes;
  }
  /// The bytes of a map's file.
  std::string bytes_of(const Map& map) const {
    write_map(path("bytes.hfm"), map);
    return content(path("bytes.hfm"));
  }
  /// What reading these bytes is refused with; "" when it is not. The file must stay as it was.
  std::string refusal_of(const std::string& bytes) const {
    write("read.hfm", bytes);
    std::string message;
    try {
      read_map(path("read.hfm"));
    } catch (const InputError& error) {
      message = error.what();
      EXPECT_THAT(message, ::testing::StartsWith(path("read.hfm").string()));
    }
    EXPECT_TRUE(content(path("read.hfm")) == bytes) << "reading changed the file";
    return message;
  }
  /// The same for a map file in which a number of a section is another one, and all checksums fit.
  std::string refusal_with(std::string bytes, const char* section, std::size_t offset, std::uint32_t value) const {
    constexpr std::size_t header = 24;
    std::memcpy(&bytes[bytes.find(section) + header + offset], &value, sizeof(value));
    repair_checksums(bytes);
    return refusal_of(bytes);
  }

  std::filesystem::path folder_;
};

}  // namespace holdfast::test
