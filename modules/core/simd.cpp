// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/simd.hpp"

#include <cstdlib>
#include <string_view>

namespace holdfast {

namespace {
SimdLevel detect() {
  SimdLevel level = SimdLevel::scalar;
#if defined(__x86_64__) || defined(__i386__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("sse4.1") && __builtin_cpu_supports("popcnt")) level = SimdLevel::sse4;
  if (level == SimdLevel::sse4 && __builtin_cpu_supports("avx2")) level = SimdLevel::avx2;
#endif
  if (const char* wanted = std::getenv("HOLDFAST_SIMD")) {
    const std::string_view name = wanted;
    if (name == "scalar") level = SimdLevel::scalar;
    if (name == "sse4" && level > SimdLevel::sse4) level = SimdLevel::sse4;
  }
  return level;
}
}  // namespace

SimdLevel simd_level() {
  static const SimdLevel level = detect();
  return level;
}

const char* to_string(SimdLevel level) {
  switch (level) {
    case SimdLevel::scalar:
      return "scalar";
    case SimdLevel::sse4:
      return "sse4";
    case SimdLevel::avx2:
      return "avx2";
  }
  return "?";
}

}  // namespace holdfast
