// SPDX-License-Identifier: BSD-3-Clause
// The vector kernels, written once: included by kernels_sse4.cpp and kernels_avx2.cpp after they have defined
// HOLDFAST_TARGET, HOLDFAST_TARGET_INLINE and the operations on vectors of `width` bytes (see there). A region whose
// width is no multiple of a vector's ends with a vector that overlaps the one before; results do not depend on it.

constexpr int bytes = Simd::bytes;
using Vector = Simd::Vector;

/// Upper bound of the score from opposite pairs of the circle: `low` and `high` gather the largest of the smaller and
/// the smallest of the larger.
HOLDFAST_TARGET_INLINE void narrow(Vector a, Vector b, Vector& low, Vector& high) {
  low = Simd::maximum(low, Simd::minimum(a, b));
  high = Simd::minimum(high, Simd::maximum(a, b));
}

HOLDFAST_TARGET_INLINE bool may_exceed(Vector centre, Vector low, Vector high, Vector threshold) {
  const Vector brighter = Simd::subtract(Simd::subtract(high, centre), threshold);
  const Vector darker = Simd::subtract(Simd::subtract(centre, low), threshold);
  return Simd::any(Simd::bit_or(brighter, darker));
}

/// The score is max over arcs of nine of min |difference|, which is max over arcs(min p) - c or c - min over
/// arcs(max p). Arcs are taken in pairs that share eight pixels.
HOLDFAST_TARGET_INLINE Vector exact_scores(Vector centre, const Vector* p) {
  Vector low2[8], high2[8], low4[8], high4[8];
  for (int i = 0; i < 8; ++i) {
    low2[i] = Simd::minimum(p[2 * i + 1], p[(2 * i + 2) & 15]);
    high2[i] = Simd::maximum(p[2 * i + 1], p[(2 * i + 2) & 15]);
  }
  for (int i = 0; i < 8; ++i) {
    low4[i] = Simd::minimum(low2[i], low2[(i + 1) & 7]);
    high4[i] = Simd::maximum(high2[i], high2[(i + 1) & 7]);
  }
  Vector brightest = Simd::fill(0), darkest = Simd::fill(255);
  for (int i = 0; i < 8; ++i) {
    const Vector low8 = Simd::minimum(low4[i], low4[(i + 2) & 7]);
    const Vector high8 = Simd::maximum(high4[i], high4[(i + 2) & 7]);
    const Vector first = p[2 * i], last = p[(2 * i + 9) & 15];
    brightest = Simd::maximum(brightest, Simd::minimum(low8, Simd::maximum(first, last)));
    darkest = Simd::minimum(darkest, Simd::maximum(high8, Simd::minimum(first, last)));
  }
  return Simd::maximum(Simd::subtract(brightest, centre), Simd::subtract(centre, darkest));
}

HOLDFAST_TARGET_INLINE void fast_scores_block(const std::uint8_t* pixel, const std::ptrdiff_t* offsets, Vector threshold,
                                              std::uint8_t* scores) {
  const Vector centre = Simd::load(pixel);
  Vector p[16];
  Vector low = Simd::fill(0), high = Simd::fill(255);
  for (const int i : {0, 4}) {
    p[i] = Simd::load(pixel + offsets[i]);
    p[i + 8] = Simd::load(pixel + offsets[i + 8]);
    narrow(p[i], p[i + 8], low, high);
  }
  if (!may_exceed(centre, low, high, threshold)) return Simd::store(scores, Simd::fill(0));
  for (const int i : {2, 6}) {
    p[i] = Simd::load(pixel + offsets[i]);
    p[i + 8] = Simd::load(pixel + offsets[i + 8]);
    narrow(p[i], p[i + 8], low, high);
  }
  if (!may_exceed(centre, low, high, threshold)) return Simd::store(scores, Simd::fill(0));
  for (int i = 1; i < 16; i += 2) p[i] = Simd::load(pixel + offsets[i]);
  const Vector score = exact_scores(centre, p);
  // score > threshold keeps score - 1.
  const Vector excess = Simd::subtract(score, threshold);
  const Vector is_none = Simd::equal(excess, Simd::fill(0));
  Simd::store(scores, Simd::and_not(is_none, Simd::subtract(score, Simd::fill(1))));
}

HOLDFAST_TARGET void fast_scores(const ImageView& region, int threshold, const OutputRows& output) {
  if (region.width < bytes) return narrower_kernels().fast_scores(region, threshold, output);
  const std::uint8_t* image = region.data;
  std::uint8_t* scores = output.data;
  const int width = region.width;
  std::ptrdiff_t offsets[16];
  for (int i = 0; i < 16; ++i) offsets[i] = circle[i][0] + circle[i][1] * region.stride;
  const Vector limit = Simd::fill(static_cast<std::uint8_t>(threshold));
  for (int y = 0; y < region.height; ++y) {
    for (int x = 0; x < width - bytes; x += bytes) fast_scores_block(image + x, offsets, limit, scores + x);
    fast_scores_block(image + width - bytes, offsets, limit, scores + width - bytes);
    image += region.stride;
    scores += output.stride;
  }
}

HOLDFAST_TARGET int local_maxima(const std::uint8_t* scores, std::ptrdiff_t stride, int width, std::uint16_t* columns) {
  if (width < bytes) return narrower_kernels().local_maxima(scores, stride, width, columns);
  int count = 0;
  for (int x = 0; x < width; x += bytes) {
    // The last vector overlaps: bits of columns that have been seen are dropped.
    const int begin = x + bytes <= width ? x : width - bytes;
    const std::uint8_t* s = scores + begin;
    const Vector score = Simd::load(s);
    if (!Simd::any(score)) continue;
    const Vector before = Simd::maximum(Simd::maximum(Simd::load(s - stride - 1), Simd::load(s - stride)),
                                        Simd::maximum(Simd::load(s - stride + 1), Simd::load(s - 1)));
    const Vector after = Simd::maximum(Simd::maximum(Simd::load(s + stride - 1), Simd::load(s + stride)),
                                       Simd::maximum(Simd::load(s + stride + 1), Simd::load(s + 1)));
    const Vector not_above = Simd::equal(Simd::subtract(score, before), Simd::fill(0));
    const Vector not_below = Simd::equal(Simd::maximum(score, after), score);
    std::uint32_t bits = Simd::mask(Simd::and_not(not_above, not_below));
    bits &= ~std::uint32_t{0} << (x - begin);
    for (; bits != 0; bits &= bits - 1) columns[count++] = static_cast<std::uint16_t>(begin + __builtin_ctz(bits));
  }
  return count;
}

HOLDFAST_TARGET void resize(const ImageView& input, const ResizeAxis& columns, const ResizeAxis& rows,
                            std::uint8_t* row, const OutputRows& output) {
  const std::ptrdiff_t input_stride = input.stride;
  const int input_width = input.width;
  const int output_width = static_cast<int>(columns.first.size());
  if (columns.block_begin.empty() || input_width < bytes || output_width < 8)
    return scalar_kernels().resize(input, columns, rows, row, output);
  const Vector half = Simd::fill16(64);
  for (std::size_t y = 0; y < rows.first.size(); ++y) {
    const std::uint8_t* upper = input.at(0, rows.first[y]);
    const Vector weights = Simd::fill_pairs(128 - rows.weight[y], rows.weight[y]);
    for (int x = 0;; x += bytes) {
      x = x + bytes <= input_width ? x : input_width - bytes;
      const Vector a = Simd::load(upper + x), b = Simd::load(upper + x + input_stride);
      const Vector low = Simd::add16(Simd::multiply_pairs(Simd::interleave_low(a, b), weights), half);
      const Vector high = Simd::add16(Simd::multiply_pairs(Simd::interleave_high(a, b), weights), half);
      Simd::store(row + x, Simd::pack(Simd::shift_right16(low), Simd::shift_right16(high)));
      if (x + bytes >= input_width) break;
    }
    std::uint8_t* out = output.data + static_cast<std::ptrdiff_t>(y) * output.stride;
    const int full_blocks = output_width / 8;
    for (int block = 0; block < full_blocks; ++block) {
      const __m128i pixels = _mm_loadu_si128(reinterpret_cast<const __m128i*>(row + columns.block_begin[block]));
      const __m128i shuffle = _mm_loadu_si128(reinterpret_cast<const __m128i*>(columns.block_shuffle[block].data()));
      const __m128i weight = _mm_loadu_si128(reinterpret_cast<const __m128i*>(columns.block_weights[block].data()));
      const __m128i sum = _mm_maddubs_epi16(_mm_shuffle_epi8(pixels, shuffle), weight);
      const __m128i rounded = _mm_srli_epi16(_mm_add_epi16(sum, _mm_set1_epi16(64)), 7);
      _mm_storel_epi64(reinterpret_cast<__m128i*>(out + 8 * block), _mm_packus_epi16(rounded, rounded));
    }
    for (int x = 8 * full_blocks; x < output_width; ++x) {
      const int first = columns.first[x], weight = columns.weight[x];
      out[x] = static_cast<std::uint8_t>((row[first] * (128 - weight) + row[first + 1] * weight + 64) >> 7);
    }
  }
}

HOLDFAST_TARGET_INLINE Vector blur_block(const std::uint8_t* p, std::ptrdiff_t step, const Vector* weights) {
  const Vector a = Simd::load(p - 3 * step), b = Simd::load(p - 2 * step), c = Simd::load(p - step);
  const Vector d = Simd::load(p), e = Simd::load(p + step), f = Simd::load(p + 2 * step), g = Simd::load(p + 3 * step);
  Vector low = Simd::fill16(64), high = Simd::fill16(64);
  low = Simd::add16(low, Simd::multiply_pairs(Simd::interleave_low(a, b), weights[0]));
  high = Simd::add16(high, Simd::multiply_pairs(Simd::interleave_high(a, b), weights[0]));
  low = Simd::add16(low, Simd::multiply_pairs(Simd::interleave_low(c, d), weights[1]));
  high = Simd::add16(high, Simd::multiply_pairs(Simd::interleave_high(c, d), weights[1]));
  low = Simd::add16(low, Simd::multiply_pairs(Simd::interleave_low(e, f), weights[2]));
  high = Simd::add16(high, Simd::multiply_pairs(Simd::interleave_high(e, f), weights[2]));
  low = Simd::add16(low, Simd::multiply_pairs(Simd::interleave_low(g, Simd::fill(0)), weights[3]));
  high = Simd::add16(high, Simd::multiply_pairs(Simd::interleave_high(g, Simd::fill(0)), weights[3]));
  return Simd::pack(Simd::shift_right16(low), Simd::shift_right16(high));
}

HOLDFAST_TARGET void blur(const ImageView& input, std::uint8_t* row, const OutputRows& output) {
  const int width = input.width;
  const int inner = width - 2 * blur_radius;
  if (inner < bytes) return scalar_kernels().blur(input, row, output);
  const Vector weights[4] = {Simd::fill_pairs(blur_weights[3], blur_weights[2]),
                             Simd::fill_pairs(blur_weights[1], blur_weights[0]),
                             Simd::fill_pairs(blur_weights[1], blur_weights[2]), Simd::fill_pairs(blur_weights[3], 0)};
  for (int y = blur_radius; y < input.height - blur_radius; ++y) {
    const std::uint8_t* in = input.at(0, y);
    for (int x = 0; x < width - bytes; x += bytes) Simd::store(row + x, blur_block(in + x, input.stride, weights));
    Simd::store(row + width - bytes, blur_block(in + width - bytes, input.stride, weights));
    std::uint8_t* out = output.data + y * output.stride + blur_radius;
    const std::uint8_t* from = row + blur_radius;
    for (int x = 0; x < inner - bytes; x += bytes) Simd::store(out + x, blur_block(from + x, 1, weights));
    Simd::store(out + inner - bytes, blur_block(from + inner - bytes, 1, weights));
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
