// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "holdfast/core/byte_writer.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast::map_io {

template <class T>
T from_little_endian(const char* data) {
  static_assert(std::is_arithmetic_v<T>);
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), data, sizeof(T));
  if constexpr (std::endian::native == std::endian::big) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

/// Reads what ByteWriter wrote; never past the end. Throws InputError, with the file, the section and the byte.
class ByteReader {
 public:
  /// `offset`: where in the file the bytes begin.
  ByteReader(std::string_view bytes, std::string file, std::string section, std::uint64_t offset)
      : bytes_(bytes), file_(std::move(file)), section_(std::move(section)), offset_(offset) {}

  template <class T>
  T get() {
    return from_little_endian<T>(take(sizeof(T)));
  }
  template <class T>
  void get_array(std::vector<T>& values, std::size_t count) {
    if (count > remaining() / sizeof(T)) fail_short(count * sizeof(T));
    const char* data = take(count * sizeof(T));
    values.resize(count);
    if constexpr (std::endian::native == std::endian::little) {
      if (count > 0) std::memcpy(values.data(), data, count * sizeof(T));
    } else {
      for (std::size_t i = 0; i < count; ++i) values[i] = from_little_endian<T>(data + i * sizeof(T));
    }
  }
  std::string_view get_bytes(std::size_t count) { return {take(count), count}; }
  /// A count of things that take at least `bytes_each`, checked against what is left, so that nobody reserves memory
  /// for what cannot be there.
  std::uint32_t get_count(std::size_t bytes_each, const char* what) {
    const auto count = get<std::uint32_t>();
    if (count > remaining() / bytes_each)
      fail("found a count of " + std::to_string(count) + " " + what + ", for which the section is too short");
    return count;
  }
  void expect_end() const {
    if (remaining() != 0) fail("found " + std::to_string(remaining()) + " bytes too many");
  }
  std::size_t remaining() const { return bytes_.size() - position_; }

  [[noreturn]] void fail(const std::string& message) const {
    throw InputError({file_}, "section '" + section_ + "', before byte " + std::to_string(offset_ + position_) + ": " +
                                  message + "; the file was written wrongly: make the map again");
  }

 private:
  const char* take(std::size_t count) {
    if (count > remaining()) fail_short(count);
    const char* data = bytes_.data() + position_;
    position_ += count;
    return data;
  }
  [[noreturn]] void fail_short(std::size_t count) const {
    fail("found " + std::to_string(remaining()) + " bytes, expected " + std::to_string(count) + " more");
  }

  std::string_view bytes_;
  std::string file_, section_;
  std::uint64_t offset_;
  std::size_t position_ = 0;
};

}  // namespace holdfast::map_io
