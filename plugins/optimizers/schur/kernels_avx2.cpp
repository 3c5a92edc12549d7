// SPDX-License-Identifier: BSD-3-Clause
#include "kernels.hpp"

#if defined(__x86_64__)
#define HOLDFAST_TARGET __attribute__((target("avx2")))
#define HOLDFAST_TARGET_INLINE HOLDFAST_TARGET __attribute__((always_inline)) inline

#include "kernels_vector.inl"

namespace holdfast::schur_plugin {

const Kernels& avx2_kernels() {
  static const Kernels table = {cost, eliminate, substitute};
  return table;
}

}  // namespace holdfast::schur_plugin
#endif
