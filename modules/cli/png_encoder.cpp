// SPDX-License-Identifier: BSD-3-Clause
#include "png_encoder.hpp"

#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "holdfast/core/check.hpp"
#ifdef HOLDFAST_LIBDEFLATE
#include <libdeflate.h>

#include <memory>
#endif

namespace holdfast {

#ifdef HOLDFAST_LIBDEFLATE

namespace {

void put_number(std::string& bytes, std::uint32_t number) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(number >> shift);
}

void put_chunk(std::string& file, const std::string& name, const std::string& content) {
  put_number(file, static_cast<std::uint32_t>(content.size()));
  const std::string named = name + content;
  file += named;
  put_number(file, libdeflate_crc32(0, named.data(), named.size()));
}

/// A row in the order of a PNG: red green blue, or the high byte first.
void to_png_order(const cv::Mat& image, int y, std::vector<std::uint8_t>& row) {
  const std::uint8_t* from = image.ptr<std::uint8_t>(y);
  if (image.type() == CV_8UC3) {
    for (int x = 0; x < 3 * image.cols; x += 3) {
      row[static_cast<std::size_t>(x)] = from[x + 2];
      row[static_cast<std::size_t>(x) + 1] = from[x + 1];
      row[static_cast<std::size_t>(x) + 2] = from[x];
    }
    return;
  }
  const auto* numbers = image.ptr<std::uint16_t>(y);
  for (int x = 0; x < image.cols; ++x) {
    row[2 * static_cast<std::size_t>(x)] = static_cast<std::uint8_t>(numbers[x] >> 8);
    row[2 * static_cast<std::size_t>(x) + 1] = static_cast<std::uint8_t>(numbers[x]);
  }
}

/// All rows, each with the filter "up": its difference to the one above.
std::vector<std::uint8_t> filtered_rows(const cv::Mat& image) {
  constexpr std::uint8_t up = 2;
  const std::size_t length = image.elemSize() * static_cast<std::size_t>(image.cols);
  std::vector<std::uint8_t> rows((length + 1) * static_cast<std::size_t>(image.rows)), above(length), row(length);
  std::uint8_t* to = rows.data();
  for (int y = 0; y < image.rows; ++y) {
    to_png_order(image, y, row);
    *to++ = up;
    for (std::size_t i = 0; i < length; ++i) to[i] = static_cast<std::uint8_t>(row[i] - above[i]);
    to += length;
    above.swap(row);
  }
  return rows;
}

std::string compressed(const std::vector<std::uint8_t>& bytes) {
  constexpr int fastest = 1;
  const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> compressor(
      libdeflate_alloc_compressor(fastest), &libdeflate_free_compressor);
  if (!compressor) throw std::bad_alloc();
  std::string result(libdeflate_zlib_compress_bound(compressor.get(), bytes.size()), '\0');
  result.resize(libdeflate_zlib_compress(compressor.get(), bytes.data(), bytes.size(), result.data(), result.size()));
  return result;
}

}  // namespace

std::string encode_png(const cv::Mat& image) {
  HOLDFAST_CHECK(image.type() == CV_8UC3 || image.type() == CV_16UC1, "an image of type " << image.type());
  const bool is_colour = image.type() == CV_8UC3;
  std::string file = "\x89PNG\r\n\x1a\n", header;
  put_number(header, static_cast<std::uint32_t>(image.cols));
  put_number(header, static_cast<std::uint32_t>(image.rows));
  header += static_cast<char>(is_colour ? 8 : 16);  // bits
  header += static_cast<char>(is_colour ? 2 : 0);   // red green blue, or grey
  header.append(3, '\0');                           // deflate, filters by row, not interlaced
  put_chunk(file, "IHDR", header);
  put_chunk(file, "IDAT", compressed(filtered_rows(image)));
  put_chunk(file, "IEND", "");
  return file;
}

#else

std::string encode_png(const cv::Mat& image) {
  HOLDFAST_CHECK(image.type() == CV_8UC3 || image.type() == CV_16UC1, "an image of type " << image.type());
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", image, bytes,
               {cv::IMWRITE_PNG_COMPRESSION, 1, cv::IMWRITE_PNG_STRATEGY, cv::IMWRITE_PNG_STRATEGY_RLE});
  return {bytes.begin(), bytes.end()};
}

#endif

}  // namespace holdfast
