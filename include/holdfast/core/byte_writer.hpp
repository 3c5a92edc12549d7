// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace holdfast {

/// The bytes of a number, least significant first, on every machine.
template <class T>
std::array<char, sizeof(T)> to_little_endian(T value) {
  static_assert(std::is_arithmetic_v<T>);
  auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if constexpr (std::endian::native == std::endian::big) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

/// Numbers one after the other, little-endian, without gaps.
class ByteWriter {
 public:
  template <class T>
  void put(T value) {
    const auto bytes = to_little_endian(value);
    bytes_.append(bytes.data(), bytes.size());
  }
  template <class T>
  void put_array(const std::vector<T>& values) {
    if constexpr (std::endian::native == std::endian::little)
      bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    else
      for (const T value : values) put(value);
  }
  void put_bytes(std::string_view bytes) { bytes_.append(bytes); }

  const std::string& bytes() const { return bytes_; }
  std::size_t size() const { return bytes_.size(); }
  void clear() { bytes_.clear(); }

 private:
  std::string bytes_;
};

}  // namespace holdfast
