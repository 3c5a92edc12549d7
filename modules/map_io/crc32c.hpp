// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

namespace holdfast::map_io {

/// CRC-32C (Castagnoli et al. 1993: polynomial 0x1EDC6F41, reflected, start and end inverted), as RFC 3720 uses it;
/// crc32c("123456789") is 0xE3069283. Finds every change of up to 32 neighbouring bits.
std::uint32_t crc32c(const void* data, std::size_t size);

}  // namespace holdfast::map_io
