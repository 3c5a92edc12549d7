// SPDX-License-Identifier: BSD-3-Clause
#include "kernels.hpp"

#define HOLDFAST_TARGET
#define HOLDFAST_TARGET_INLINE __attribute__((always_inline)) inline

#include "kernels_vector.inl"

namespace holdfast::schur_plugin {

const Kernels& baseline_kernels() {
  static const Kernels table = {cost, eliminate, substitute};
  return table;
}

}  // namespace holdfast::schur_plugin
