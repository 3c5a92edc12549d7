// SPDX-License-Identifier: BSD-3-Clause
#include "png_plain.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <string_view>

#if defined(HOLDFAST_LIBDEFLATE)
#include <libdeflate.h>
#endif

#include "holdfast/image_files/image_structure.hpp"
#include "png_filters.hpp"

namespace holdfast {

#if defined(HOLDFAST_LIBDEFLATE)

namespace {

using Buffer = std::vector<std::uint8_t>;

std::size_t number_at(const std::uint8_t* p) {
  return std::size_t{p[0]} << 24 | std::size_t{p[1]} << 16 | std::size_t{p[2]} << 8 | p[3];
}

void append_big_endian(Buffer& to, std::size_t value) {
  for (const int shift : {24, 16, 8, 0}) to.push_back(static_cast<std::uint8_t>(value >> shift));
}

/// What the pixels of a file depend on.
struct Parts {
  std::span<const std::uint8_t> header;  ///< the 13 bytes of IHDR
  Buffer palette;                        ///< of PLTE; empty where the pixels are no indices
  Buffer compressed;                     ///< of all IDAT chunks

  std::size_t width() const { return number_at(header.data()); }
  std::size_t height() const { return number_at(&header[4]); }
  std::size_t bits_per_pixel() const {
    const int colour_type = header[9];
    const std::size_t channels = colour_type == 2 ? 3 : colour_type == 4 ? 2 : colour_type == 6 ? 4 : 1;
    return channels * header[8];
  }
  bool is_interlaced() const { return header[12] == 1; }
  bool is_indexed() const { return header[9] == 3; }
};

Parts parts_of(std::span<const std::uint8_t> file) {
  Parts parts;
  for (std::size_t at = 8; file.size() - at >= 12;) {
    const std::size_t length = number_at(&file[at]);
    const std::string_view name(reinterpret_cast<const char*>(&file[at + 4]), 4);
    const std::span<const std::uint8_t> data = file.subspan(at + 8, length);
    if (name == "IHDR") parts.header = data;
    if (name == "PLTE" && parts.is_indexed()) parts.palette.assign(data.begin(), data.end());
    if (name == "IDAT") parts.compressed.insert(parts.compressed.end(), data.begin(), data.end());
    if (name == "IEND") break;
    at += 12 + length;
  }
  // Decoders paint an index without an entry black, and some print a message.
  if (parts.is_indexed()) parts.palette.resize(std::size_t{3} << parts.header[8], 0);
  return parts;
}

/// A grid of rows in the decompressed data: the whole image, or one pass of an interlaced one.
struct Pass {
  std::size_t rows = 0, bytes_per_row = 0;  ///< of a row after its byte with the filter's number
  std::size_t size() const { return rows * (1 + bytes_per_row); }
};

/// Section 8.2: the passes of Adam7, without those that are empty.
std::vector<Pass> passes_of(const Parts& parts) {
  struct Grid {
    std::size_t x, y, step_x, step_y;
  };
  static constexpr std::array<Grid, 7> adam7 = {
      {{0, 0, 8, 8}, {4, 0, 8, 8}, {0, 4, 4, 8}, {2, 0, 4, 4}, {0, 2, 2, 4}, {1, 0, 2, 2}, {0, 1, 1, 2}}};
  static constexpr std::array<Grid, 1> whole = {{{0, 0, 1, 1}}};
  std::vector<Pass> passes;
  for (const Grid& grid : parts.is_interlaced() ? std::span<const Grid>(adam7) : std::span<const Grid>(whole)) {
    if (grid.x >= parts.width() || grid.y >= parts.height()) continue;
    const std::size_t columns = (parts.width() - grid.x + grid.step_x - 1) / grid.step_x;
    const std::size_t rows = (parts.height() - grid.y + grid.step_y - 1) / grid.step_y;
    passes.push_back({rows, (columns * parts.bits_per_pixel() + 7) / 8});
  }
  return passes;
}

/// The filtered rows of all passes; nothing where the data are damaged. Data after the end of the stream are allowed.
std::optional<Buffer> filtered_rows(const Parts& parts) {
  const std::vector<Pass> passes = passes_of(parts);
  std::size_t size = 0;
  for (const Pass& pass : passes) size += pass.size();
  constexpr std::size_t best_compression = 1032;  // of deflate
  if (size > best_compression * parts.compressed.size()) return {};
  Buffer rows(size);
  const std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> decompressor(
      libdeflate_alloc_decompressor(), &libdeflate_free_decompressor);
  std::size_t decompressed = 0;
  if (decompressor == nullptr ||
      libdeflate_zlib_decompress(decompressor.get(), parts.compressed.data(), parts.compressed.size(), rows.data(),
                                 rows.size(), &decompressed) != LIBDEFLATE_SUCCESS ||
      decompressed != size)
    return {};
  std::size_t at = 0;
  for (const Pass& pass : passes)
    for (std::size_t row = 0; row < pass.rows; ++row, at += 1 + pass.bytes_per_row)
      if (rows[at] > static_cast<std::uint8_t>(PngFilter::paeth)) return {};
  return rows;
}

/// A stream of zlib (RFC 1950) that holds the bytes in stored blocks (RFC 1951, section 3.2.4).
Buffer stored_stream(const Buffer& content) {
  constexpr std::size_t largest_block = 65535;
  Buffer stream = {0x78, 0x01};
  stream.reserve(content.size() + content.size() / largest_block * 5 + 16);
  for (std::size_t at = 0; at < content.size();) {
    const std::size_t length = std::min(content.size() - at, largest_block);
    const bool is_last = at + length == content.size();
    for (const std::size_t byte : {std::size_t{is_last}, length & 0xff, length >> 8, ~length & 0xff, ~length >> 8})
      stream.push_back(static_cast<std::uint8_t>(byte));
    const auto begin = content.begin() + static_cast<std::ptrdiff_t>(at);
    stream.insert(stream.end(), begin, begin + static_cast<std::ptrdiff_t>(length));
    at += length;
  }
  append_big_endian(stream, libdeflate_adler32(1, content.data(), content.size()));
  return stream;
}

void append_chunk(Buffer& to, std::string_view name, std::span<const std::uint8_t> data) {
  append_big_endian(to, data.size());
  const std::size_t begin = to.size();
  to.insert(to.end(), name.begin(), name.end());
  to.insert(to.end(), data.begin(), data.end());
  append_big_endian(to, libdeflate_crc32(0, &to[begin], to.size() - begin));
}

}  // namespace

std::optional<std::vector<std::uint8_t>> plain_png(std::span<const std::uint8_t> file) {
  const Parts parts = parts_of(file);
  const std::optional<Buffer> rows = filtered_rows(parts);
  if (!rows) return {};
  Buffer plain(file.begin(), file.begin() + 8);  // the signature
  plain.reserve(rows->size() + rows->size() / 1000 + 1024);
  append_chunk(plain, "IHDR", parts.header);
  if (parts.is_indexed()) append_chunk(plain, "PLTE", parts.palette);
  append_chunk(plain, "IDAT", stored_stream(*rows));
  append_chunk(plain, "IEND", {});
  return plain;
}

#else

std::optional<std::vector<std::uint8_t>> plain_png(std::span<const std::uint8_t> file) {
  std::vector<std::uint8_t> plain(file.begin(), file.end());
  drop_png_annotations(plain);
  return plain;
}

#endif

}  // namespace holdfast
