// SPDX-License-Identifier: BSD-3-Clause
// Headers of PNG and JPEG files, and the decoder behind them for images of up to 64 x 64 pixels. Checksums of PNG
// chunks are made anew for an input that ends in an odd byte.
#include <opencv2/core.hpp>
#include <vector>

#include "fuzz.hpp"
#include "holdfast/image_files/image_decoder.hpp"
#include "holdfast/image_files/image_structure.hpp"

using namespace holdfast;

namespace {

std::uint32_t big_endian(const std::uint8_t* bytes) {
  return std::uint32_t{bytes[0]} << 24U | std::uint32_t{bytes[1]} << 16U | std::uint32_t{bytes[2]} << 8U | bytes[3];
}

/// CRC-32 of ISO/IEC 15948, annex D.
std::uint32_t crc32(const std::uint8_t* bytes, std::size_t count) {
  std::uint32_t sum = 0xffffffffU;
  for (std::size_t i = 0; i < count; ++i) {
    sum ^= bytes[i];
    for (int bit = 0; bit < 8; ++bit) sum = (sum & 1U) != 0 ? 0xedb88320U ^ (sum >> 1U) : sum >> 1U;
  }
  return ~sum;
}

/// ISO/IEC 15948: a signature of 8 bytes; chunks of length, type, data, and the CRC-32 of type and data.
void repair_checksums(std::vector<std::uint8_t>& bytes) {
  for (std::size_t begin = 8; begin + 12 <= bytes.size();) {
    const std::size_t length = big_endian(bytes.data() + begin);
    if (length > bytes.size() - begin - 12) return;
    const std::uint32_t sum = crc32(bytes.data() + begin + 4, length + 4);
    for (std::size_t i = 0; i < 4; ++i) bytes[begin + 8 + length + i] = static_cast<std::uint8_t>(sum >> (24 - 8 * i));
    begin += 12 + length;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::uint8_t> bytes(data, data + size);
  if (!bytes.empty() && bytes.back() % 2 != 0) repair_checksums(bytes);
  const auto file = fuzz::folder().write("image.png", bytes);
  fuzz::accepts([&] {
    const ImageStructure structure = examine_image(bytes);
    structure.to_string();
    const bool is_small = std::int64_t{structure.width} * structure.height <= 4096;
    if (structure.problem.empty() && structure.palette && is_small) palette_indices_as_grey(bytes);
  });
  const auto only_small = [](const cv::Size& found) {
    if (found.width > 64 || found.height > 64) throw InputError({"image.png"}, "is too large here");
  };
  ImageDecoder decoder;
  fuzz::accepts([&] {
    const cv::Mat colour = decoder.read_colour(file, only_small);
    fuzz::require(colour.type() == CV_8UC3 && !colour.empty(), "colour is 8UC3");
  });
  fuzz::accepts([&] {
    const cv::Mat depth = decoder.read_depth(file, 5000.0, only_small);
    fuzz::require(depth.type() == CV_32FC1 && !depth.empty(), "depth is 32FC1");
  });
  fuzz::accepts([&] {
    const cv::Mat labels = decoder.read_labels(file, only_small);
    fuzz::require(labels.type() == CV_8UC1 || labels.type() == CV_16UC1, "labels are 8UC1 or 16UC1");
  });
  return 0;
}
