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

  block_output.clear();
  block_begin.clear();
  block_shuffle.clear();
  block_weights.clear();
  constexpr int block = 8, pair = 2 * block;
  if (output_size < pair) return;
  for (int i = 0; i + block <= output_size; ++i)
    if (first[i + block - 1] + 1 - first[i] > 15) return;
  for (int begin = 0; begin < output_size; begin += pair)
    for (const int half : {0, block}) {
      const int output = std::min(begin, output_size - pair) + half;
      block_output.push_back(output);
      block_begin.push_back(first[output]);
      auto& shuffle = block_shuffle.emplace_back();
      auto& weights = block_weights.emplace_back();
      for (int i = 0; i < block; ++i) {
        shuffle[2 * i] = static_cast<std::uint8_t>(first[output + i] - first[output]);
        shuffle[2 * i + 1] = static_cast<std::uint8_t>(shuffle[2 * i] + 1);
        weights[2 * i] = static_cast<std::int8_t>(128 - weight[output + i]);
        weights[2 * i + 1] = static_cast<std::int8_t>(weight[output + i]);
      }
    }
}

const Kernels& kernels(SimdLevel level) {
  HOLDFAST_CHECK(has_simd_level(level), to_string(level) << " asked for, " << to_string(simd_level()) << " available");
#if defined(__x86_64__)
  if (level == SimdLevel::avx512) return avx512_kernels();
  if (level == SimdLevel::avx2) return avx2_kernels();
  if (level == SimdLevel::sse4) return sse4_kernels();
#elif defined(__aarch64__)
  if (level == SimdLevel::neon) return neon_kernels();
#endif
  return scalar_kernels();
}

}  // namespace holdfast::orb_plugin
