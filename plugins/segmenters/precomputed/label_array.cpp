// SPDX-License-Identifier: BSD-3-Clause
#include "label_array.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/core/input_file.hpp"
#include "holdfast/image_files/numpy_array.hpp"
#include "npz_member.hpp"

namespace holdfast::precomputed_plugin {

namespace {

constexpr const char* expected_arrays =
    "; expected an array of NumPy (.npy or .npz) with labels, height x width, or with masks, instances x height x "
    "width, "
    "boolean or whole numbers; save it with numpy.save()";

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& found) {
  throw InputError({file.string()}, found + expected_arrays);
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

LabelArray read_label_array(const std::filesystem::path& file) {
  InputFile input(file, largest_file::image, "an array of labels (.npy, .npz)");
  const bool is_archive = file.extension() == ".npz";
  const std::uint64_t member_size = is_archive ? seek_label_array(input, expected_arrays) : 0;
  const NumpyHeader header = read_numpy_header(input, expected_arrays);
  if (header.has_fortran_order) fail(file, "is an array in Fortran's order");
  const std::size_t size = size_of(header.type);
  if (size == 0) fail(file, "has values of the type '" + header.type + "'");
  std::vector<std::size_t> shape = header.shape;
  if (shape.size() == 2) shape.insert(shape.begin(), 1);
  constexpr std::size_t most_side = 16384, most_images = 65535;
  if (shape.size() != 3 || shape[0] > most_images || shape[1] < 1 || shape[2] < 1 || shape[1] > most_side ||
      shape[2] > most_side)
    fail(file, "is an array of " + shape_text(header));
  std::vector<std::uint8_t> bytes;
  const std::size_t pixels = shape[1] * shape[2];
  if (is_archive) {
    bytes.resize(static_cast<std::size_t>(std::min<std::uint64_t>(shape[0] * pixels * size, member_size)));
    bytes.resize(input.read(bytes.data(), bytes.size()));
  } else {
    input.read_rest(bytes);
  }
  if (bytes.size() != shape[0] * pixels * size)
    fail(file, "has " + std::to_string(bytes.size()) + " bytes of values for " + shape_text(header));
  LabelArray result{{}, header.shape.size() == 3};
  const std::uint8_t* from = bytes.data();
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

}  // namespace holdfast::precomputed_plugin
