// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

/// What the processor offers to the integer kernels. Every kernel gives the same bits at every level.
enum class SimdLevel { scalar = 0, sse4 = 1, avx2 = 2 };

/// The best level of this processor; the environment variable HOLDFAST_SIMD (scalar, sse4, avx2) can lower it.
SimdLevel simd_level();
const char* to_string(SimdLevel level);

}  // namespace holdfast
