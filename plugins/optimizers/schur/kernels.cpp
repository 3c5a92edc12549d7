// SPDX-License-Identifier: BSD-3-Clause
#include "kernels.hpp"

#include "holdfast/core/check.hpp"

namespace holdfast::schur_plugin {

const Kernels& kernels(SimdLevel level) {
  HOLDFAST_CHECK(has_simd_level(level), to_string(level) << " asked for, " << to_string(simd_level()) << " available");
#if defined(__x86_64__)
  if (level >= SimdLevel::avx2) return avx2_kernels();
#endif
  return baseline_kernels();
}

}  // namespace holdfast::schur_plugin
