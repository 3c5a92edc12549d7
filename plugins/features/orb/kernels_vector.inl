// SPDX-License-Identifier: BSD-3-Clause
// The kernels for vectors of 16 or 32 bytes, written once: included by kernels_sse4.cpp, kernels_avx2.cpp and
// kernels_neon.cpp after kernels_any_width.inl.

HOLDFAST_TARGET void resize(const ImageView& input, const ResizeAxis& columns, const ResizeAxis& rows,
                            std::uint8_t* row, const OutputRows& output) {
  const std::ptrdiff_t input_stride = input.stride;
  const int input_width = input.width;
  if (columns.block_output.empty() || input_width < bytes)
    return scalar_kernels().resize(input, columns, rows, row, output);
  // Bytes may alias the tables, so that the compiler would load these for every block.
  const std::size_t blocks = columns.block_output.size();
  const int *first_output = columns.block_output.data(), *begin = columns.block_begin.data();
  const auto* shuffle = columns.block_shuffle.data();
  const auto* block_weights = columns.block_weights.data();
  for (std::size_t y = 0; y < rows.first.size(); ++y) {
    const std::uint8_t* upper = input.at(0, rows.first[y]);
    const Simd::PairWeights weights = Simd::fill_pairs(128 - rows.weight[y], rows.weight[y]);
    for (int x = 0;; x += bytes) {
      x = x + bytes <= input_width ? x : input_width - bytes;
      const Vector a = Simd::load(upper + x), b = Simd::load(upper + x + input_stride);
      const Vector low = Simd::divide_by_128(Simd::multiply_pairs(Simd::interleave_low(a, b), weights));
      const Vector high = Simd::divide_by_128(Simd::multiply_pairs(Simd::interleave_high(a, b), weights));
      Simd::store(row + x, Simd::pack(low, high));
      if (x + bytes >= input_width) break;
    }
    std::uint8_t* out = output.data + static_cast<std::ptrdiff_t>(y) * output.stride;
    for (std::size_t block = 0; block < blocks; block += Simd::blocks) {
      const Vector pairs = Simd::shuffle(Simd::load_blocks(row, begin + block), Simd::load(shuffle + block));
      const Vector sums = Simd::multiply_pairs(pairs, Simd::load(block_weights + block));
      Simd::store_blocks(out + first_output[block], Simd::divide_by_128(sums));
    }
  }
}

/// Weights of the moment kernels: per row of the disc, its columns' offsets (0 outside) and its row offset inside.
struct MomentWeights {
  alignas(32) std::int8_t x[2 * patch_radius + 1][32] = {};
  alignas(32) std::int8_t y[2 * patch_radius + 1][32] = {};
  constexpr MomentWeights() {
    for (int row = -patch_radius; row <= patch_radius; ++row) {
      const int half_width = patch_half_width[row < 0 ? -row : row];
      for (int column = -half_width; column <= half_width; ++column) {
        x[row + patch_radius][column + patch_radius] = static_cast<std::int8_t>(column);
        y[row + patch_radius][column + patch_radius] = static_cast<std::int8_t>(row);
      }
    }
  }
};
constexpr MomentWeights moment_weights;

HOLDFAST_TARGET void moments(const std::uint8_t* centre, std::ptrdiff_t stride, int& moment_x, int& moment_y) {
  Vector sum_x = Simd::fill(0), sum_y = Simd::fill(0);
  const std::uint8_t* row = centre - patch_radius * stride - patch_radius;
  for (int y = 0; y <= 2 * patch_radius; ++y, row += stride) {
    for (int part = 0; part < 32; part += bytes) {
      const Vector grey = Simd::load(row + part);
      sum_x = Simd::add32(sum_x, Simd::widen(Simd::multiply_pairs(grey, Simd::load(moment_weights.x[y] + part))));
      sum_y = Simd::add32(sum_y, Simd::widen(Simd::multiply_pairs(grey, Simd::load(moment_weights.y[y] + part))));
    }
  }
  moment_x = Simd::sum32(sum_x);
  moment_y = Simd::sum32(sum_y);
}
