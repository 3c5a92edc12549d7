// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace holdfast {

/// Writes a PNG (ISO/IEC 15948) that examine_image() accepted anew: the same pixels in a stored instead of a compressed
/// stream, a palette with an entry for every index, and nothing besides. All that libpng could dislike, and print
/// about, is gone: what damage can be under a right checksum (a stream that breaks off, goes on, or names no filter) is
/// found here, and gives nothing; so does a header that asks for more than the file's data can hold, before memory is
/// taken. A build without libdeflate finds no such damage, and only leaves out what the pixels do not depend on.
std::optional<std::vector<std::uint8_t>> plain_png(std::span<const std::uint8_t> file);

}  // namespace holdfast
