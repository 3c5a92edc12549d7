// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "holdfast/core/crc32.hpp"

namespace holdfast::map_io {

/// The checksum of a block.
inline std::uint32_t crc32c(const void* data, std::size_t size) {
  return Crc32c().add({static_cast<const std::uint8_t*>(data), size}).value();
}

}  // namespace holdfast::map_io
