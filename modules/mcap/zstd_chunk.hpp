// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#ifdef HOLDFAST_ZSTD
#include <zstd.h>

#include "holdfast/core/check.hpp"
#endif

namespace holdfast::mcap {

/// One zstd frame with the bytes of a chunk. Not to be called in a build without zstd.
#ifdef HOLDFAST_ZSTD
inline constexpr bool has_zstd = true;
inline std::string compress_zstd(const std::string& bytes) {
  constexpr int fastest = 1;
  std::string compressed(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size = ZSTD_compress(compressed.data(), compressed.size(), bytes.data(), bytes.size(), fastest);
  HOLDFAST_CHECK(ZSTD_isError(size) == 0, ZSTD_getErrorName(size));
  compressed.resize(size);
  return compressed;
}
#else
inline constexpr bool has_zstd = false;
inline std::string compress_zstd(const std::string& bytes) { return bytes; }
#endif

}  // namespace holdfast::mcap
