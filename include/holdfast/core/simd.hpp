// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace holdfast {

/// SIMD instruction set of the integer kernels. Every kernel gives bit-identical results at every level.
enum class SimdLevel { scalar = 0, sse4 = 1, avx2 = 2, avx512 = 3 };

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
  }
  return "?";
}

namespace detail {
inline SimdLevel detect_simd_level() {
  SimdLevel level = SimdLevel::scalar;
#if defined(__x86_64__) || defined(__i386__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("sse4.1") && __builtin_cpu_supports("popcnt")) level = SimdLevel::sse4;
  if (level == SimdLevel::sse4 && __builtin_cpu_supports("avx2")) level = SimdLevel::avx2;
  if (level == SimdLevel::avx2 && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"))
    level = SimdLevel::avx512;
#endif
  if (const char* wanted = std::getenv("HOLDFAST_SIMD")) {
    for (const SimdLevel lower : {SimdLevel::scalar, SimdLevel::sse4, SimdLevel::avx2})
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

}  // namespace holdfast
