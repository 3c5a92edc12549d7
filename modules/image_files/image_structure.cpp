// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/image_structure.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "holdfast/core/error.hpp"
#include "holdfast/core/input_file.hpp"
#include "holdfast/core/size_text.hpp"

namespace holdfast {

namespace {

using Bytes = std::span<const std::uint8_t>;

std::uint32_t big_endian_16(const std::uint8_t* p) { return std::uint32_t{p[0]} << 8 | p[1]; }
std::uint32_t big_endian_32(const std::uint8_t* p) { return big_endian_16(p) << 16 | big_endian_16(p + 2); }

/// Tables of the PNG checksum (ISO/IEC 15948, annex D), eight bytes at a time: table k advances a byte by k more bytes.
constexpr std::array<std::array<std::uint32_t, 256>, 8> make_checksum_tables() {
  std::array<std::array<std::uint32_t, 256>, 8> tables{};
  for (std::uint32_t n = 0; n < 256; ++n) {
    std::uint32_t value = n;
    for (int bit = 0; bit < 8; ++bit) value = (value & 1) ? 0xedb88320u ^ (value >> 1) : value >> 1;
    tables[0][n] = value;
  }
  for (std::size_t k = 1; k < 8; ++k)
    for (std::size_t n = 0; n < 256; ++n) tables[k][n] = tables[0][tables[k - 1][n] & 0xff] ^ (tables[k - 1][n] >> 8);
  return tables;
}
constexpr auto checksum_tables = make_checksum_tables();

std::uint32_t png_checksum(Bytes bytes) {
  const auto& t = checksum_tables;
  std::uint32_t value = 0xffffffffu;
  const std::uint8_t* p = bytes.data();
  std::size_t left = bytes.size();
  for (; left >= 8; left -= 8, p += 8) {
    value ^= std::uint32_t{p[0]} | std::uint32_t{p[1]} << 8 | std::uint32_t{p[2]} << 16 | std::uint32_t{p[3]} << 24;
    value = t[7][value & 0xff] ^ t[6][(value >> 8) & 0xff] ^ t[5][(value >> 16) & 0xff] ^ t[4][value >> 24] ^
            t[3][p[4]] ^ t[2][p[5]] ^ t[1][p[6]] ^ t[0][p[7]];
  }
  for (; left > 0; --left, ++p) value = t[0][(value ^ *p) & 0xff] ^ (value >> 8);
  return ~value;
}

std::string truncated(std::size_t size, const char* expected) {
  return "is truncated: it ends after " + std::to_string(size) + " bytes, before " + expected;
}

constexpr std::array<std::uint8_t, 8> png_signature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

bool is_png(Bytes bytes) {
  return bytes.size() >= png_signature.size() && std::equal(png_signature.begin(), png_signature.end(), bytes.begin());
}

/// Whether the 13 bytes of an IHDR chunk describe one of the kinds of images that exist (table 11.1).
bool is_png_header(const std::uint8_t* data) {
  const int bits = data[8], colour_type = data[9];
  const auto is_one_of = [bits](auto... allowed) { return ((bits == allowed) || ...); };
  const bool fits = colour_type == 0   ? is_one_of(1, 2, 4, 8, 16)
                    : colour_type == 3 ? is_one_of(1, 2, 4, 8)
                                       : (colour_type == 2 || colour_type == 4 || colour_type == 6) && is_one_of(8, 16);
  return fits && data[10] == 0 && data[11] == 0 && data[12] <= 1;
}

/// Chunks that a decoder must understand begin with an upper-case letter.
bool is_critical(const std::string& chunk) { return (chunk[0] & 0x20) == 0; }

void examine_png(Bytes bytes, ImageStructure& image) {
  image.format = ImageStructure::Format::png;
  constexpr const char* end = "its IEND chunk";
  bool has_data = false, has_palette = false;
  for (std::size_t at = png_signature.size();;) {
    if (bytes.size() - at < 12) return void(image.problem = truncated(bytes.size(), end));
    const std::size_t length = big_endian_32(&bytes[at]);
    const char* type = reinterpret_cast<const char*>(&bytes[at + 4]);
    if (bytes.size() - at - 12 < length) return void(image.problem = truncated(bytes.size(), end));
    const std::uint8_t* data = &bytes[at + 8];
    const std::string name(type, 4);
    if (png_checksum(bytes.subspan(at + 4, length + 4)) != big_endian_32(data + length))
      return void(image.problem = "is damaged: the checksum of its chunk at byte " + std::to_string(at) + " is wrong");
    if (at == png_signature.size()) {
      if (name != "IHDR" || length != 13)
        return void(image.problem = "is damaged: it does not begin with an IHDR chunk");
      if (!is_png_header(data)) return void(image.problem = "is damaged: its header describes no kind of image");
      image.width = static_cast<int>(std::min<std::uint32_t>(big_endian_32(data), 0x7fffffffu));
      image.height = static_cast<int>(std::min<std::uint32_t>(big_endian_32(data + 4), 0x7fffffffu));
      const int colour_type = data[9];
      const bool palette = colour_type == 3;
      image.palette = palette;
      image.index_bits = palette ? data[8] : 8;
      image.bits = palette ? 8 : data[8];
      image.channels = palette || colour_type == 2 ? 3 : colour_type == 6 ? 4 : colour_type == 4 ? 2 : 1;
    } else if (is_critical(name) && name != "PLTE" && name != "IDAT" && name != "IEND") {
      return void(image.problem = "holds a chunk at byte " + std::to_string(at) + " that no PNG image has there");
    }
    if (name == "PLTE" && image.palette) {
      if (has_palette || has_data || length == 0 || length % 3 != 0 || length > 3U << image.index_bits)
        return void(image.problem = "is damaged: its palette has a wrong size or place");
      has_palette = true;
    }
    has_data |= name == "IDAT";
    if (name == "IEND") break;
    at += 12 + length;
  }
  if (!has_data)
    image.problem = "is damaged: it holds no image data (no IDAT chunk)";
  else if (image.palette && !has_palette)
    image.problem = "is damaged: it holds no palette (no PLTE chunk)";
}

void examine_jpeg(Bytes bytes, ImageStructure& image) {
  image.format = ImageStructure::Format::jpeg;
  constexpr const char* end = "its end-of-image marker";
  bool has_scan = false;
  for (std::size_t at = 2;;) {
    // A marker: any number of fill bytes 0xFF, then a code. After a scan, entropy-coded data come first.
    const void* found = at < bytes.size() ? std::memchr(&bytes[at], 0xff, bytes.size() - at) : nullptr;
    if (found == nullptr) return void(image.problem = truncated(bytes.size(), end));
    const auto position = static_cast<std::size_t>(static_cast<const std::uint8_t*>(found) - bytes.data());
    if (position != at && !has_scan)
      return void(image.problem = "is damaged: no JPEG marker at byte " + std::to_string(at));
    at = position + 1;
    if (at >= bytes.size()) return void(image.problem = truncated(bytes.size(), end));
    const int code = bytes[at];
    if (code == 0xff) continue;
    ++at;
    if (code == 0xd9) break;
    if (code == 0x00 || code == 0x01 || (code >= 0xd0 && code <= 0xd7)) continue;
    if (bytes.size() - at < 2) return void(image.problem = truncated(bytes.size(), end));
    const std::size_t length = big_endian_16(&bytes[at]);
    if (length < 2)
      return void(image.problem = "is damaged: a JPEG segment of no length at byte " + std::to_string(at));
    if (bytes.size() - at < length) return void(image.problem = truncated(bytes.size(), end));
    const bool frame_header = code >= 0xc0 && code <= 0xcf && code != 0xc4 && code != 0xc8 && code != 0xcc;
    if (frame_header && length >= 8) {
      image.bits = bytes[at + 2];
      image.height = static_cast<int>(big_endian_16(&bytes[at + 3]));
      image.width = static_cast<int>(big_endian_16(&bytes[at + 5]));
      image.channels = bytes[at + 7];
    }
    has_scan |= code == 0xda;
    at += length;
  }
  if (!has_scan || image.width == 0) image.problem = "is damaged: it holds no image data (no JPEG scan)";
}

}  // namespace

std::string ImageStructure::to_string() const {
  return size_text(width, height) + ", " + std::to_string(channels) +
         (channels == 1 ? " channel of " : " channels of ") + std::to_string(bits) + " bits";
}

namespace {

/// Above this the decoding library refuses an image, and prints.
constexpr int largest_side = 1 << 15;
/// Decoded, a colour image of that size takes 0.6 GB for a moment.
constexpr int largest_millions = 100;

}  // namespace

bool ImageStructure::has_camera_size() const {
  return width >= 1 && height >= 1 && width <= largest_side && height <= largest_side &&
         std::int64_t{width} * height <= largest_millions * std::int64_t{1'000'000};
}

std::string ImageStructure::largest() {
  return std::to_string(largest_side) + " pixels in width and height, and " + std::to_string(largest_millions) +
         " million pixels";
}

ImageStructure examine_image(std::span<const std::uint8_t> bytes) {
  ImageStructure image;
  if (bytes.empty())
    image.problem = "is empty (0 bytes)";
  else if (is_png(bytes))
    examine_png(bytes, image);
  else if (bytes.size() >= 3 && bytes[0] == 0xff && bytes[1] == 0xd8 && bytes[2] == 0xff)
    examine_jpeg(bytes, image);
  else
    image.problem = "is neither a PNG nor a JPEG image";
  return image;
}

namespace {

/// Up to `count` bytes of a file from `begin` on.
std::vector<std::uint8_t> bytes_of(InputFile& file, std::uint64_t begin, std::uint64_t count) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(count));
  file.seek(begin);
  bytes.resize(file.read(bytes.data(), bytes.size()));
  return bytes;
}

bool is_end(ImageStructure::Format format, const std::vector<std::uint8_t>& last) {
  static constexpr std::array<std::uint8_t, 12> png_end = {0, 0, 0, 0, 'I', 'E', 'N', 'D', 0xae, 0x42, 0x60, 0x82};
  static constexpr std::array<std::uint8_t, 2> jpeg_end = {0xff, 0xd9};
  const auto ends_with = [&](const auto& end) {
    return last.size() >= end.size() && std::equal(end.rbegin(), end.rend(), last.rbegin());
  };
  return format == ImageStructure::Format::png ? ends_with(png_end) : ends_with(jpeg_end);
}

}  // namespace

ImageStructure examine_image_ends(const std::filesystem::path& file) {
  constexpr std::uint64_t begin_size = 1 << 14, end_size = 12;
  InputFile stream(file, largest_file::image, "a PNG or JPEG image");
  const std::uint64_t size = stream.size();
  if (size > begin_size) {
    ImageStructure image = examine_image(bytes_of(stream, 0, begin_size));
    if (image.width > 0 && is_end(image.format, bytes_of(stream, size - end_size, end_size))) {
      image.problem.clear();
      return image;
    }
  }
  return examine_image(bytes_of(stream, 0, size));
}

void drop_png_annotations(std::vector<std::uint8_t>& bytes) {
  if (!is_png(bytes)) return;
  auto end = bytes.begin() + static_cast<std::ptrdiff_t>(png_signature.size());
  bool palette = false;
  for (std::size_t at = png_signature.size(); bytes.size() - at >= 12;) {
    const std::size_t length = big_endian_32(&bytes[at]) + 12;
    const std::string name(reinterpret_cast<const char*>(&bytes[at + 4]), 4);
    if (name == "IHDR") palette = bytes[at + 17] == 3;
    if (is_critical(name) && (name != "PLTE" || palette)) {
      const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(at);
      if (end != begin) std::copy(begin, begin + static_cast<std::ptrdiff_t>(length), end);
      end += static_cast<std::ptrdiff_t>(length);
    }
    if (name == "IEND") break;
    at += length;
  }
  bytes.erase(end, bytes.end());
}

std::vector<std::uint8_t> palette_indices_as_grey(Bytes bytes) {
  std::vector<std::uint8_t> grey(png_signature.begin(), png_signature.end());
  grey.reserve(bytes.size());
  for (std::size_t at = png_signature.size(); bytes.size() - at >= 12;) {
    const std::size_t length = big_endian_32(&bytes[at]) + 12;
    const std::string name(reinterpret_cast<const char*>(&bytes[at + 4]), 4);
    if (name == "IHDR" || name == "IDAT" || name == "IEND") {  // the others may speak of the palette
      const std::size_t begin = grey.size();
      grey.insert(grey.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at),
                  bytes.begin() + static_cast<std::ptrdiff_t>(at + length));
      if (name == "IHDR") {
        grey[begin + 17] = 0;  // colour type: grey
        const std::uint32_t checksum = png_checksum(Bytes(grey).subspan(begin + 4, length - 8));
        for (std::size_t i = 0; i < 4; ++i)
          grey[begin + length - 4 + i] = static_cast<std::uint8_t>(checksum >> (24 - 8 * i));
      }
    }
    if (name == "IEND") break;
    at += length;
  }
  return grey;
}

}  // namespace holdfast
