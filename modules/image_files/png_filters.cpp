// SPDX-License-Identifier: BSD-3-Clause
#include "png_filters.hpp"

#include <cstdlib>
#include <cstring>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace holdfast {

namespace {

std::uint8_t paeth_predictor(int left, int up, int up_left) {
  const int to_left = std::abs(up - up_left), to_up = std::abs(left - up_left);
  const int to_up_left = std::abs(left + up - 2 * up_left);
  if (to_left <= to_up && to_left <= to_up_left) return static_cast<std::uint8_t>(left);
  return static_cast<std::uint8_t>(to_up <= to_up_left ? up : up_left);
}

void reconstruct_paeth_bytes(std::uint8_t* row, const std::uint8_t* previous, std::size_t begin, std::size_t size,
                             std::size_t step) {
  for (std::size_t i = begin; i < size; ++i) {
    const bool is_first = i < step;
    row[i] = static_cast<std::uint8_t>(
        row[i] + paeth_predictor(is_first ? 0 : row[i - step], previous[i], is_first ? 0 : previous[i - step]));
  }
}

#if defined(__SSE2__)

/// A pixel of up to four bytes in the low half, as 16-bit numbers.
template <std::size_t step>
__m128i load_pixel(const std::uint8_t* from) {
  std::uint32_t bytes = 0;
  std::memcpy(&bytes, from, step);
  return _mm_unpacklo_epi8(_mm_cvtsi32_si128(static_cast<int>(bytes)), _mm_setzero_si128());
}

/// Stores the pixel in the low half.
template <std::size_t step>
void store_pixel(__m128i pixel, std::uint8_t* to) {
  const int bytes = _mm_cvtsi128_si32(_mm_packus_epi16(pixel, pixel));
  std::memcpy(to, &bytes, step);
}

__m128i absolute(__m128i value) { return _mm_max_epi16(value, _mm_sub_epi16(_mm_setzero_si128(), value)); }
__m128i choose(__m128i condition, __m128i yes, __m128i no) {
  return _mm_or_si128(_mm_and_si128(condition, yes), _mm_andnot_si128(condition, no));
}

__m128i paeth_predictor(__m128i left, __m128i up, __m128i up_left) {
  const __m128i up_step = _mm_sub_epi16(up, up_left), left_step = _mm_sub_epi16(left, up_left);
  const __m128i to_left = absolute(up_step), to_up = absolute(left_step);
  const __m128i to_up_left = absolute(_mm_add_epi16(up_step, left_step));
  const __m128i nearest = _mm_min_epi16(to_up_left, _mm_min_epi16(to_left, to_up));
  return choose(_mm_cmpeq_epi16(nearest, to_left), left, choose(_mm_cmpeq_epi16(nearest, to_up), up, up_left));
}

/// The low half of the vectors holds the upper row, the high half the lower row one pixel behind it: what is above a
/// pixel of the lower row was computed in the step before.
template <std::size_t step>
void reconstruct_two_paeth_rows_of(std::uint8_t* upper, std::uint8_t* lower, const std::uint8_t* previous,
                                   std::size_t size) {
  const __m128i byte_mask = _mm_set1_epi16(0xff);
  const auto pair = [](__m128i low, __m128i high) { return _mm_unpacklo_epi64(low, high); };
  // The first pixel of the upper row alone.
  reconstruct_paeth_bytes(upper, previous, 0, step, step);
  __m128i left = load_pixel<step>(upper);  // high half: nothing is left of the first pixel
  __m128i up_left = load_pixel<step>(previous);
  for (std::size_t i = step; i < size; i += step) {
    const __m128i up = pair(load_pixel<step>(previous + i), left);
    const __m128i residual = pair(load_pixel<step>(upper + i), load_pixel<step>(lower + i - step));
    left = _mm_and_si128(_mm_add_epi16(residual, paeth_predictor(left, up, up_left)), byte_mask);
    up_left = up;
    store_pixel<step>(left, upper + i);
    store_pixel<step>(_mm_srli_si128(left, 8), lower + i - step);
  }
  reconstruct_paeth_bytes(lower, upper, size - step, size, step);
}

#endif

template <std::size_t step>
void reconstruct_row_of(PngFilter filter, std::uint8_t* row, const std::uint8_t* previous, std::size_t size) {
  switch (filter) {
    case PngFilter::none:
      break;
    case PngFilter::sub:
      for (std::size_t i = step; i < size; ++i) row[i] = static_cast<std::uint8_t>(row[i] + row[i - step]);
      break;
    case PngFilter::up:
      for (std::size_t i = 0; i < size; ++i) row[i] = static_cast<std::uint8_t>(row[i] + previous[i]);
      break;
    case PngFilter::average:
      for (std::size_t i = 0; i < step; ++i) row[i] = static_cast<std::uint8_t>(row[i] + previous[i] / 2);
      for (std::size_t i = step; i < size; ++i)
        row[i] = static_cast<std::uint8_t>(row[i] + (row[i - step] + previous[i]) / 2);
      break;
    case PngFilter::paeth:
#if defined(__SSE2__)
    {
      const __m128i byte_mask = _mm_set1_epi16(0xff);
      __m128i left = _mm_setzero_si128(), up_left = left;
      for (std::size_t i = 0; i < size; i += step) {
        const __m128i up = load_pixel<step>(previous + i);
        left = _mm_and_si128(_mm_add_epi16(load_pixel<step>(row + i), paeth_predictor(left, up, up_left)), byte_mask);
        up_left = up;
        store_pixel<step>(left, row + i);
      }
    }
#else
      reconstruct_paeth_bytes(row, previous, 0, size, step);
#endif
    break;
  }
}

}  // namespace

void reconstruct_row(PngFilter filter, std::uint8_t* row, const std::uint8_t* previous, std::size_t size,
                     std::size_t bytes_per_pixel) {
  if (bytes_per_pixel == 2)
    reconstruct_row_of<2>(filter, row, previous, size);
  else
    reconstruct_row_of<3>(filter, row, previous, size);
}

void reconstruct_two_paeth_rows(std::uint8_t* upper, std::uint8_t* lower, const std::uint8_t* previous,
                                std::size_t size, std::size_t bytes_per_pixel) {
#if defined(__SSE2__)
  if (bytes_per_pixel == 2)
    reconstruct_two_paeth_rows_of<2>(upper, lower, previous, size);
  else
    reconstruct_two_paeth_rows_of<3>(upper, lower, previous, size);
#else
  reconstruct_row(PngFilter::paeth, upper, previous, size, bytes_per_pixel);
  reconstruct_row(PngFilter::paeth, lower, upper, size, bytes_per_pixel);
#endif
}

}  // namespace holdfast
