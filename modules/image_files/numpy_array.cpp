// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/numpy_array.hpp"

#include <array>
#include <charconv>
#include <cstdint>
#include <string_view>

#include "holdfast/core/error.hpp"

namespace holdfast {

namespace {

/// Reads the header of one file.
class HeaderReader {
 public:
  HeaderReader(InputFile& input, const std::string& expected) : input_(input), expected_(expected) {}

  NumpyHeader read() {
    const std::string text = read_text();
    NumpyHeader header;
    if (const std::string type = value(text, "descr"); type.starts_with('\''))
      header.type = type.substr(1, type.find('\'', 1) - 1);
    header.has_fortran_order = !value(text, "fortran_order").starts_with("False");
    header.shape = read_shape(value(text, "shape"));
    return header;
  }

 private:
  [[noreturn]] void refuse(const char* found) const {
    throw InputError({input_.path().string()}, std::string(found) + expected_);
  }

  /// A dictionary of Python: {'descr': '<f8', 'fortran_order': False, 'shape': (5, 4, 4), }
  std::string read_text() {
    std::array<char, 8> magic{};
    const bool has_magic = input_.read(magic.data(), magic.size()) == magic.size();
    if (!has_magic || std::string_view(magic.data(), 6) != "\x93NUMPY") refuse("is no .npy file");
    std::array<unsigned char, 4> bytes{};
    const std::size_t size_bytes = magic[6] == 1 ? 2 : 4;
    const bool has_size = input_.read(bytes.data(), size_bytes) == size_bytes;
    std::size_t size = 0;
    for (std::size_t i = 0; i < size_bytes; ++i) size |= std::size_t{bytes[i]} << (8 * i);
    constexpr std::size_t longest = 1 << 16;
    if (!has_size || size > longest) refuse("has no header that can be read");
    std::string text(size, ' ');
    if (input_.read(text.data(), size) != size) refuse("has no header that can be read");
    return text;
  }

  static std::string value(const std::string& text, const std::string& key) {
    const std::size_t begin = text.find("'" + key + "':");
    if (begin == std::string::npos) return "";
    const std::size_t first = text.find_first_not_of(' ', begin + key.size() + 3);
    return first == std::string::npos ? "" : text.substr(first);
  }

  /// A tuple of Python, such as (5, 4, 4) or (5,).
  std::vector<std::size_t> read_shape(const std::string& text) const {
    constexpr std::size_t largest = std::size_t{1} << 24;
    std::vector<std::size_t> shape;
    if (!text.starts_with('(')) refuse("is no array that can be read");
    const char *at = text.data() + 1, *const end = text.data() + text.size();
    while (at != end && *at != ')') {
      if (*at == ' ' || *at == ',') {
        ++at;
        continue;
      }
      std::size_t size = 0;
      const auto [stop, error] = std::from_chars(at, end, size);
      if (error == std::errc::result_out_of_range || size > largest) refuse("is an array that is too large");
      if (error != std::errc()) refuse("is no array that can be read");
      shape.push_back(size);
      at = stop;
    }
    if (at == end) refuse("is no array that can be read");
    return shape;
  }

  InputFile& input_;
  const std::string& expected_;
};

}  // namespace

NumpyHeader read_numpy_header(InputFile& input, const std::string& expected) {
  return HeaderReader(input, expected).read();
}

std::string shape_text(const NumpyHeader& header) {
  std::string text;
  for (const std::size_t size : header.shape) text += (text.empty() ? "" : " x ") + std::to_string(size);
  return text.empty() ? "one number" : text;
}

}  // namespace holdfast
