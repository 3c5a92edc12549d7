// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

namespace holdfast {

/// Filters of PNG rows (ISO/IEC 15948, section 9.2).
enum class PngFilter : std::uint8_t { none, sub, up, average, paeth };

/// Replaces the filtered bytes of a row by the original ones. `previous`: the original row above, zeros for the first.
/// bytes_per_pixel is 2 or 3.
void reconstruct_row(PngFilter filter, std::uint8_t* row, const std::uint8_t* previous, std::size_t size,
                     std::size_t bytes_per_pixel);

/// Reconstructs two successive rows that both have Paeth's filter, in the time of one: a pixel waits for its left
/// neighbour only, so that the lower row follows one pixel behind the upper one.
void reconstruct_two_paeth_rows(std::uint8_t* upper, std::uint8_t* lower, const std::uint8_t* previous,
                                std::size_t size, std::size_t bytes_per_pixel);

}  // namespace holdfast
