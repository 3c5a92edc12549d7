// SPDX-License-Identifier: BSD-3-Clause
#include "png_rows.hpp"

#include <memory>
#include <string_view>

#if defined(HOLDFAST_LIBDEFLATE)
#include <libdeflate.h>
#endif

#include "png_filters.hpp"

namespace holdfast {

#if defined(HOLDFAST_LIBDEFLATE)

namespace {

std::size_t big_endian(const std::uint8_t* p) {
  return std::size_t{p[0]} << 24 | std::size_t{p[1]} << 16 | std::size_t{p[2]} << 8 | p[3];
}

bool decompress(const std::vector<std::uint8_t>& compressed, std::vector<std::uint8_t>& to) {
  const std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> decompressor(
      libdeflate_alloc_decompressor(), &libdeflate_free_decompressor);
  std::size_t size = 0;
  return decompressor != nullptr &&
         libdeflate_zlib_decompress(decompressor.get(), compressed.data(), compressed.size(), to.data(), to.size(),
                                    &size) == LIBDEFLATE_SUCCESS &&
         size == to.size();
}

}  // namespace

bool PngRows::read_chunks(std::span<const std::uint8_t> file) {
  constexpr std::size_t signature = 8, header = 8, checksum = 4;
  compressed_.clear();
  for (std::size_t at = signature; file.size() - at >= header + checksum;) {
    const std::size_t length = big_endian(&file[at]);
    const std::string_view name(reinterpret_cast<const char*>(&file[at + 4]), 4);
    const std::uint8_t* data = &file[at + header];
    if (name == "IHDR") {
      width_ = static_cast<int>(big_endian(data));
      height_ = static_cast<int>(big_endian(data + 4));
      const int bits = data[8], colour_type = data[9];
      const bool is_plain = data[10] == 0 && data[11] == 0 && data[12] == 0;  // compression, filters, interlacing
      bytes_per_pixel_ = colour_type == 0 && bits == 16 ? 2 : colour_type == 2 && bits == 8 ? 3 : 0;
      if (bytes_per_pixel_ == 0 || !is_plain) return false;
    } else if (name == "IDAT") {
      compressed_.insert(compressed_.end(), data, data + length);
    } else if (name == "tRNS") {
      return false;
    } else if (name == "IEND") {
      return bytes_per_pixel_ != 0;
    }
    at += header + length + checksum;
  }
  return false;
}

bool PngRows::reconstruct() {
  const std::vector<std::uint8_t> zeros(bytes_per_row_, 0);
  const std::uint8_t* previous = zeros.data();
  const auto filter_of = [this](int y) { return static_cast<PngFilter>(*(row(y) - 1)); };
  const auto pixels_of = [this](int y) { return rows_.data() + (row(y) - rows_.data()); };
  const auto step = static_cast<std::size_t>(bytes_per_pixel_);
  for (int y = 0; y < height_; ++y) {
    if (filter_of(y) > PngFilter::paeth) return false;
    if (filter_of(y) == PngFilter::paeth && y + 1 < height_ && filter_of(y + 1) == PngFilter::paeth) {
      reconstruct_two_paeth_rows(pixels_of(y), pixels_of(y + 1), previous, bytes_per_row_, step);
      ++y;
    } else {
      reconstruct_row(filter_of(y), pixels_of(y), previous, bytes_per_row_, step);
    }
    previous = row(y);
  }
  return true;
}

bool PngRows::decode(std::span<const std::uint8_t> file) {
  if (!read_chunks(file)) return false;
  bytes_per_row_ = static_cast<std::size_t>(width_) * static_cast<std::size_t>(bytes_per_pixel_);
  const std::size_t size = bytes_to_next_row() * static_cast<std::size_t>(height_);
  constexpr std::size_t best_compression = 1032;  // of deflate; a small file does not get much memory
  if (size > best_compression * compressed_.size()) return false;
  rows_.resize(size);
  return decompress(compressed_, rows_) && reconstruct();
}

#else

bool PngRows::decode(std::span<const std::uint8_t>) { return false; }

#endif

}  // namespace holdfast
