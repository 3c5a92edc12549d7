// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace holdfast {

/// Decodes the pixels of common PNG files (ISO/IEC 15948) faster than libpng: libdeflate decompresses them, and two
/// rows with Paeth's filter are reconstructed at once. Keeps its buffers between images; used by one thread.
class PngRows {
 public:
  /// Decodes a file that examine_image() accepted. False if it is not one for this decoder, which leaves it to another:
  /// anything but grey of 16 bits or colour of 3 x 8 bits without interlacing and transparency, damaged data, and every
  /// file in a build without libdeflate.
  bool decode(std::span<const std::uint8_t> file);

  /// The samples of a row from the left to the right; those of 16 bits have the high byte first. Valid until the next
  /// decode().
  const std::uint8_t* row(int y) const { return rows_.data() + static_cast<std::size_t>(y) * bytes_to_next_row() + 1; }
  std::size_t bytes_to_next_row() const { return bytes_per_row_ + 1; }
  int width() const { return width_; }
  int height() const { return height_; }
  int bytes_per_pixel() const { return bytes_per_pixel_; }  ///< 2 or 3

 private:
  bool read_chunks(std::span<const std::uint8_t> file);
  bool reconstruct();

  int width_ = 0, height_ = 0, bytes_per_pixel_ = 0;
  std::size_t bytes_per_row_ = 0;
  std::vector<std::uint8_t> compressed_, rows_;  // rows_: each row after its byte with the filter's number
};

}  // namespace holdfast
