// SPDX-License-Identifier: BSD-3-Clause
#include "kernels.hpp"

#include <algorithm>
#include <cmath>

#include "holdfast/core/error.hpp"

namespace holdfast::orb_plugin {

void ResizeAxis::build(int input_size, int output_size) {
  const double ratio = static_cast<double>(input_size) / output_size;
  first.resize(output_size);
  weight.resize(output_size);
  for (int i = 0; i < output_size; ++i) {
    const double position = (i + 0.5) * ratio - 0.5;
    first[i] = std::clamp(static_cast<int>(std::floor(position)), 0, std::max(0, input_size - 2));
    weight[i] = static_cast<std::uint8_t>(std::clamp(std::lround((position - first[i]) * 128.0), 1L, 127L));
  }

  block_begin.clear();
  block_shuffle.clear();
  block_weights.clear();
  for (int begin = 0; begin < output_size; begin += 8) {
    const int end = std::min(begin + 8, output_size);
    if (first[end - 1] + 1 - first[begin] > 15) {
      block_begin.clear();
      return;
    }
    block_begin.push_back(first[begin]);
    auto& shuffle = block_shuffle.emplace_back();
    auto& weights = block_weights.emplace_back();
    for (int i = begin; i < end; ++i) {
      const int pair = 2 * (i - begin);
      shuffle[pair] = static_cast<std::uint8_t>(first[i] - first[begin]);
      shuffle[pair + 1] = static_cast<std::uint8_t>(shuffle[pair] + 1);
      weights[pair] = static_cast<std::int8_t>(128 - weight[i]);
      weights[pair + 1] = static_cast<std::int8_t>(weight[i]);
    }
  }
}

const Kernels& kernels(SimdLevel level) {
  HOLDFAST_CHECK(level <= simd_level(), to_string(level) << " asked for, " << to_string(simd_level()) << " available");
#if defined(__x86_64__)
  if (level == SimdLevel::avx2) return avx2_kernels();
  if (level == SimdLevel::sse4) return sse4_kernels();
#endif
  return scalar_kernels();
}

}  // namespace holdfast::orb_plugin
