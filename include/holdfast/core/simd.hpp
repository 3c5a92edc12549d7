// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>

#include "holdfast/core/platform.hpp"

namespace holdfast {

/// SIMD instruction set of the kernels. Every kernel gives bit-identical results at every level. The levels of one
/// architecture ascend; simd_levels lists them.
enum class SimdLevel { scalar = 0, sse4 = 1, avx2 = 2, avx512 = 3, neon = 4 };

/// The levels of the architecture that this is compiled for, ascending. Every aarch64 processor has NEON.
#if defined(__aarch64__)
inline constexpr std::array simd_levels = {SimdLevel::scalar, SimdLevel::neon};
#elif defined(__x86_64__)
inline constexpr std::array simd_levels = {SimdLevel::scalar, SimdLevel::sse4, SimdLevel::avx2, SimdLevel::avx512};
#else
inline constexpr std::array simd_levels = {SimdLevel::scalar};
#endif

/// The name of a level, as in HOLDFAST_SIMD.
inline const char* to_string(SimdLevel level) {
  switch (level) {
    case SimdLevel::scalar:
      return "scalar";
    case SimdLevel::sse4:
      return "sse4";
    case SimdLevel::avx2:
      return "avx2";
    case SimdLevel::avx512:
      return "avx512";
    case SimdLevel::neon:
      return "neon";
  }
  return "?";
}

namespace detail {
inline SimdLevel detect_simd_level() {
  SimdLevel level = SimdLevel::scalar;
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("sse4.1") && __builtin_cpu_supports("popcnt")) level = SimdLevel::sse4;
  if (level == SimdLevel::sse4 && __builtin_cpu_supports("avx2")) level = SimdLevel::avx2;
  if (level == SimdLevel::avx2 && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"))
    level = SimdLevel::avx512;
#elif defined(__aarch64__)
  level = SimdLevel::neon;
#endif
  if (const char* wanted = std::getenv("HOLDFAST_SIMD")) {
    for (const SimdLevel lower : simd_levels)
      if (std::string_view(wanted) == to_string(lower)) level = std::min(level, lower);
  }
  return level;
}
}  // namespace detail

/// The highest level that this processor supports; the environment variable HOLDFAST_SIMD (scalar, sse4, avx2) can
/// lower it.
inline SimdLevel simd_level() {
  static const SimdLevel level = detail::detect_simd_level();
  return level;
}

/// Whether this build and processor have a level, HOLDFAST_SIMD considered.
inline bool has_simd_level(SimdLevel level) {
  return level <= simd_level() && std::find(simd_levels.begin(), simd_levels.end(), level) != simd_levels.end();
}

}  // namespace holdfast
