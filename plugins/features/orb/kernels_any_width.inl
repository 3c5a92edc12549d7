// SPDX-License-Identifier: BSD-3-Clause
// The kernels for vectors of any width, written once: included by kernels_sse4.cpp, kernels_avx2.cpp,
// kernels_avx512.cpp and kernels_neon.cpp after they have defined HOLDFAST_TARGET, HOLDFAST_TARGET_INLINE and the operations on vectors of
// Simd::bytes (see there). A region whose width is no multiple of a vector's ends with a vector that overlaps the one
// before; results do not depend on it.

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

HOLDFAST_TARGET_INLINE void fast_scores_block(const std::uint8_t* pixel, const std::ptrdiff_t* offsets,
                                              Vector threshold, std::uint8_t* scores) {
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
    Simd::Bits bits = Simd::mask(Simd::and_not(not_above, not_below));
    bits &= ~Simd::Bits{0} << (x - begin);
    for (; bits != 0; bits &= bits - 1) columns[count++] = static_cast<std::uint16_t>(begin + __builtin_ctzll(bits));
  }
  return count;
}

/// Weights of the blur of two adjacent outputs, in pairs: an output reads seven inputs, so that eight serve both.
struct BlurWeights {
  Simd::PairWeights first[4] = {Simd::fill_pairs(blur_weights[3], blur_weights[2]),
                     Simd::fill_pairs(blur_weights[1], blur_weights[0]),
                     Simd::fill_pairs(blur_weights[1], blur_weights[2]), Simd::fill_pairs(blur_weights[3], 0)};
  Simd::PairWeights second[4] = {Simd::fill_pairs(0, blur_weights[3]), Simd::fill_pairs(blur_weights[2], blur_weights[1]),
                      Simd::fill_pairs(blur_weights[0], blur_weights[1]),
                      Simd::fill_pairs(blur_weights[2], blur_weights[3])};
  HOLDFAST_TARGET_INLINE BlurWeights() {}
};

/// Weighted mean of pairs of inputs, in 16 bits.
template <class Pairs>
HOLDFAST_TARGET_INLINE Vector blur_pairs(const Pairs* pairs, const Simd::PairWeights* weights) {
  const Vector near =
      Simd::add16(Simd::multiply_pairs(pairs[0], weights[0]), Simd::multiply_pairs(pairs[1], weights[1]));
  const Vector far =
      Simd::add16(Simd::multiply_pairs(pairs[2], weights[2]), Simd::multiply_pairs(pairs[3], weights[3]));
  return Simd::divide_by_128(Simd::add16(near, far));
}

/// Blurs down the columns: a vector of the row of `p` and of the one below.
HOLDFAST_TARGET_INLINE void blur_down(const std::uint8_t* p, std::ptrdiff_t stride, const BlurWeights& weights,
                                      std::uint8_t* first, std::uint8_t* second) {
  Simd::Pairs low[4], high[4];
  for (int i = 0; i < 4; ++i) {
    const Vector a = Simd::load(p + (2 * i - 3) * stride), b = Simd::load(p + (2 * i - 2) * stride);
    low[i] = Simd::interleave_low(a, b);
    high[i] = Simd::interleave_high(a, b);
  }
  Simd::store(first, Simd::pack(blur_pairs(low, weights.first), blur_pairs(high, weights.first)));
  Simd::store(second, Simd::pack(blur_pairs(low, weights.second), blur_pairs(high, weights.second)));
}

/// Blurs along a row: the pairs of a vector's even outputs are those of its odd ones.
HOLDFAST_TARGET_INLINE Vector blur_along(const std::uint8_t* p, const BlurWeights& weights) {
  const Vector pairs[4] = {Simd::load(p - 3), Simd::load(p - 1), Simd::load(p + 1), Simd::load(p + 3)};
  return Simd::bit_or(blur_pairs(pairs, weights.first), Simd::to_high_bytes(blur_pairs(pairs, weights.second)));
}

HOLDFAST_TARGET void blur(const ImageView& input, std::uint8_t* rows, const OutputRows& output) {
  const int width = input.width;
  const int inner = width - 2 * blur_radius, last = input.height - blur_radius - 2;
  if (inner < bytes || last < blur_radius) return scalar_kernels().blur(input, rows, output);
  const BlurWeights weights;
  for (int y = blur_radius; y <= last + 1; y += 2) {
    const int upper = y < last ? y : last;  // the last two rows overlap those before if their number is odd
    const std::uint8_t* in = input.at(0, upper);
    for (int x = 0; x < width - bytes; x += bytes) blur_down(in + x, input.stride, weights, rows + x, rows + width + x);
    blur_down(in + width - bytes, input.stride, weights, rows + width - bytes, rows + 2 * width - bytes);
    for (int i = 0; i < 2; ++i) {
      std::uint8_t* out = output.data + (upper + i) * output.stride + blur_radius;
      const std::uint8_t* from = rows + i * width + blur_radius;
      for (int x = 0; x < inner - bytes; x += bytes) Simd::store(out + x, blur_along(from + x, weights));
      Simd::store(out + inner - bytes, blur_along(from + inner - bytes, weights));
    }
  }
}
