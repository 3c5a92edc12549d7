// SPDX-License-Identifier: BSD-3-Clause
#include "label_array.hpp"

#include <cctype>
#include <cstddef>
#include <string>
#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/core/input_file.hpp"

namespace holdfast::precomputed_plugin {

namespace {

constexpr const char* expected_arrays =
    "; expected an array of NumPy (.npy) with labels, height x width, or with masks, instances x height x width, "
    "boolean "
    "or whole numbers; save it with numpy.save()";

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& found) {
  throw InputError({file.string()}, found + expected_arrays);
}

/// The dictionary of an array: {'descr': '|u1', 'fortran_order': False, 'shape': (480, 640), }
struct ArrayHeader {
  std::string type;  ///< "u1", "<i8"
  std::vector<std::size_t> shape;
  std::size_t data = 0;  ///< where the values begin
};

std::string value_of(const std::string& dictionary, const std::string& key) {
  const std::size_t at = dictionary.find("'" + key + "':");
  if (at == std::string::npos) return "";
  std::size_t first = at + key.size() + 3;
  while (first < dictionary.size() && dictionary[first] == ' ') ++first;
  return dictionary.substr(first);
}

std::vector<std::size_t> read_shape(const std::string& text, const std::filesystem::path& file) {
  constexpr std::size_t most = std::size_t{1} << 24;
  std::vector<std::size_t> shape;
  if (text.empty() || text.front() != '(') fail(file, "is no array that can be read");
  std::size_t value = 0;
  bool has_digits = false;
  for (const char c : text.substr(1)) {
    if (std::isdigit(static_cast<unsigned char>(c)) != 0) {
      value = value * 10 + static_cast<std::size_t>(c - '0'), has_digits = true;
      if (value > most) fail(file, "is an array that is too large");
    } else if (c == ',' || c == ')') {
      if (has_digits) shape.push_back(value);
      value = 0, has_digits = false;
      if (c == ')') return shape;
    } else if (c != ' ') {
      break;
    }
  }
  fail(file, "is no array that can be read");
}

ArrayHeader read_header(std::span<const std::uint8_t> bytes, const std::filesystem::path& file) {
  const std::string magic = "\x93NUMPY";
  constexpr std::size_t lengths = 8;  // where the length of the dictionary is
  if (bytes.size() < lengths + 4 || std::string(bytes.begin(), bytes.begin() + 6) != magic)
    fail(file, "is no array of NumPy");
  const std::size_t width = bytes[6] == 1 ? 2 : 4;
  std::size_t length = 0;
  for (std::size_t i = 0; i < width; ++i) length |= std::size_t{bytes[lengths + i]} << (8 * i);
  const std::size_t first = lengths + width;
  if (length > bytes.size() - first) fail(file, "ends within its header");
  const std::string dictionary(bytes.begin() + static_cast<std::ptrdiff_t>(first),
                               bytes.begin() + static_cast<std::ptrdiff_t>(first + length));
  ArrayHeader header;
  const std::string type = value_of(dictionary, "descr");
  if (type.size() > 4 && type[0] == '\'') header.type = type.substr(1, type.find('\'', 1) - 1);
  if (!value_of(dictionary, "fortran_order").starts_with("False")) fail(file, "is an array in Fortran's order");
  header.shape = read_shape(value_of(dictionary, "shape"), file);
  header.data = first + length;
  return header;
}

/// Bytes of a value; 0 for types that are no labels.
std::size_t size_of(const std::string& type) {
  for (const char* known : {"|b1", "|u1", "|i1"})
    if (type == known) return 1;
  for (const char* known : {"<u2", "<i2", "<u4", "<i4", "<u8", "<i8"})
    if (type == known) return static_cast<std::size_t>(known[2] - '0');
  return 0;
}

}  // namespace

LabelArray parse_label_array(std::span<const std::uint8_t> bytes, const std::filesystem::path& file) {
  const ArrayHeader header = read_header(bytes, file);
  const std::size_t size = size_of(header.type);
  if (size == 0) fail(file, "has values of the type '" + header.type + "'");
  std::vector<std::size_t> shape = header.shape;
  if (shape.size() == 2) shape.insert(shape.begin(), 1);
  constexpr std::size_t most_side = 16384, most_images = 65535;
  std::string text;
  for (const std::size_t side : header.shape) text += (text.empty() ? "" : " x ") + std::to_string(side);
  if (shape.size() != 3 || shape[0] > most_images || shape[1] < 1 || shape[2] < 1 || shape[1] > most_side ||
      shape[2] > most_side)
    fail(file, "is an array of " + (text.empty() ? "one number" : text));
  const std::size_t pixels = shape[1] * shape[2];
  if (bytes.size() - header.data != shape[0] * pixels * size)
    fail(file, "has " + std::to_string(bytes.size() - header.data) + " bytes of values for " + text);
  LabelArray result{{}, header.shape.size() == 3};
  const std::uint8_t* from = bytes.data() + header.data;
  for (std::size_t i = 0; i < shape[0]; ++i) {
    cv::Mat image(static_cast<int>(shape[1]), static_cast<int>(shape[2]), CV_16UC1);
    auto* to = image.ptr<std::uint16_t>();
    for (std::size_t pixel = 0; pixel < pixels; ++pixel, from += size) {
      std::uint64_t value = 0;
      for (std::size_t byte = 0; byte < size; ++byte) value |= std::uint64_t{from[byte]} << (8 * byte);
      const bool is_negative = header.type[1] == 'i' && (from[size - 1] & 0x80) != 0;
      if (is_negative || value > 65535) fail(file, "has a value outside 0 to 65535");
      to[pixel] = static_cast<std::uint16_t>(value);
    }
    result.images.push_back(std::move(image));
  }
  return result;
}

LabelArray read_label_array(const std::filesystem::path& file) {
  std::vector<std::uint8_t> bytes;
  InputFile(file, largest_file::image, "an array of labels (.npy)").read_rest(bytes);
  return parse_label_array(bytes, file);
}

}  // namespace holdfast::precomputed_plugin
