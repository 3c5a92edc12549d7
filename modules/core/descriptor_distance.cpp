// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/descriptor_distance.hpp"

#include <bit>
#include <cmath>

#include "holdfast/core/check.hpp"
#include "holdfast/core/simd.hpp"

#if defined(__aarch64__)
#include "descriptor_distance_neon.hpp"
#endif

namespace holdfast {

namespace {

#define HOLDFAST_INLINE __attribute__((always_inline)) static inline

/// Eight numbers, on which the compiler works with the instructions of the function into which a kernel is inlined.
using Float8 = float __attribute__((vector_size(32)));
static_assert(sizeof(Float8) == sizeof(Descriptor256));

/// The sum of eight lanes, in one order on every processor.
HOLDFAST_INLINE float sum_of_lanes(const Float8& lanes) {
  return ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) + ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
}

/// Hamming distance of 256 bits.
struct Bits256 {
  HOLDFAST_INLINE float of(const Descriptor256* a, const Descriptor256* b, std::size_t) {
    return static_cast<float>(std::popcount(a->words[0] ^ b->words[0]) + std::popcount(a->words[1] ^ b->words[1]) +
                              std::popcount(a->words[2] ^ b->words[2]) + std::popcount(a->words[3] ^ b->words[3]));
  }
};

/// Hamming distance of any number of bits.
struct Bits {
  HOLDFAST_INLINE float of(const Descriptor256* a, const Descriptor256* b, std::size_t units) {
    int distance = 0;
    for (std::size_t unit = 0; unit < units; ++unit)
      for (std::size_t word = 0; word < 4; ++word) distance += std::popcount(a[unit].words[word] ^ b[unit].words[word]);
    return static_cast<float>(distance);
  }
};

struct FloatEuclidean {
  HOLDFAST_INLINE float of(const Descriptor256* a, const Descriptor256* b, std::size_t units) {
    const auto* numbers_a = reinterpret_cast<const Float8*>(a);
    const auto* numbers_b = reinterpret_cast<const Float8*>(b);
    Float8 sums{};
    for (std::size_t unit = 0; unit < units; ++unit) {
      const Float8 difference = numbers_a[unit] - numbers_b[unit];
      sums += difference * difference;
    }
    return std::sqrt(sum_of_lanes(sums));
  }
};

struct FloatCosine {
  HOLDFAST_INLINE float of(const Descriptor256* a, const Descriptor256* b, std::size_t units) {
    const auto* numbers_a = reinterpret_cast<const Float8*>(a);
    const auto* numbers_b = reinterpret_cast<const Float8*>(b);
    Float8 sums{};
    for (std::size_t unit = 0; unit < units; ++unit) sums += numbers_a[unit] * numbers_b[unit];
    return 1.0F - sum_of_lanes(sums);
  }
};

struct Int8Euclidean {
  HOLDFAST_INLINE float of(const Descriptor256* a, const Descriptor256* b, std::size_t units) {
    const auto* numbers_a = reinterpret_cast<const std::int8_t*>(a);
    const auto* numbers_b = reinterpret_cast<const std::int8_t*>(b);
    int sum = 0;
    for (std::size_t i = 0; i < units * sizeof(Descriptor256); ++i) {
      const int difference = numbers_a[i] - numbers_b[i];
      sum += difference * difference;
    }
    return std::sqrt(static_cast<float>(sum));
  }
};

struct Int8Cosine {
  HOLDFAST_INLINE float of(const Descriptor256* a, const Descriptor256* b, std::size_t units) {
    const auto* numbers_a = reinterpret_cast<const std::int8_t*>(a);
    const auto* numbers_b = reinterpret_cast<const std::int8_t*>(b);
    int product = 0, length_a = 0, length_b = 0;
    for (std::size_t i = 0; i < units * sizeof(Descriptor256); ++i) {
      product += numbers_a[i] * numbers_b[i];
      length_a += numbers_a[i] * numbers_a[i];
      length_b += numbers_b[i] * numbers_b[i];
    }
    if (length_a == 0 || length_b == 0) return 1.0F;
    return 1.0F - static_cast<float>(product) /
                      (std::sqrt(static_cast<float>(length_a)) * std::sqrt(static_cast<float>(length_b)));
  }
};

// The same three loops for every kernel, once per set of instructions.
#define HOLDFAST_LOOPS(name, target)                                                                        \
  template <class Kernel>                                                                                   \
  struct name {                                                                                             \
    target static float two(const Descriptor256* a, const Descriptor256* b, std::size_t units) {            \
      return Kernel::of(a, b, units);                                                                       \
    }                                                                                                       \
    target static void rows(const Descriptor256* query, const Descriptor256* rows, std::size_t units,       \
                            std::size_t count, float* distances) {                                          \
      for (std::size_t i = 0; i < count; ++i) distances[i] = Kernel::of(query, rows + i * units, units);    \
    }                                                                                                       \
    target static void candidates(const Descriptor256* query, const Descriptor256* rows, std::size_t units, \
                                  std::span<const std::uint32_t> candidates, float* distances) {            \
      for (std::size_t i = 0; i < candidates.size(); ++i)                                                   \
        distances[i] = Kernel::of(query, rows + candidates[i] * units, units);                              \
    }                                                                                                       \
  };

HOLDFAST_LOOPS(ScalarLoops, )
#if defined(__x86_64__)
HOLDFAST_LOOPS(Sse4Loops, __attribute__((target("sse4.1,popcnt"))))
HOLDFAST_LOOPS(Avx2Loops, __attribute__((target("avx2,popcnt"))))
#endif

#if defined(__aarch64__)
/// The kernel of NEON in place of a scalar one.
template <class Kernel>
struct OnNeon {
  using type = Kernel;
};
template <>
struct OnNeon<Bits256> {
  using type = neon::Bits256;
};
template <>
struct OnNeon<Bits> {
  using type = neon::Bits;
};
template <>
struct OnNeon<Int8Euclidean> {
  using type = neon::Int8Euclidean;
};
template <>
struct OnNeon<Int8Cosine> {
  using type = neon::Int8Cosine;
};
#endif

#undef HOLDFAST_LOOPS
#undef HOLDFAST_INLINE

}  // namespace

template <class Kernel>
void DescriptorDistances::use(SimdLevel level) {
  const auto take = [&](auto loops) {
    using Loops = decltype(loops);
    two_ = Loops::two, rows_ = Loops::rows, candidates_ = Loops::candidates;
  };
#if defined(__x86_64__)
  if (level >= SimdLevel::avx2) return take(Avx2Loops<Kernel>());
  if (level >= SimdLevel::sse4) return take(Sse4Loops<Kernel>());
#elif defined(__aarch64__)
  if (level == SimdLevel::neon) return take(ScalarLoops<typename OnNeon<Kernel>::type>());
#endif
  take(ScalarLoops<Kernel>());
}

DescriptorDistances::DescriptorDistances(const DescriptorType& type, SimdLevel level)
    : units_(DescriptorView::units_of(type)) {
  HOLDFAST_CHECK(has_simd_level(level), to_string(level) << " asked for, " << to_string(simd_level()) << " available");
  const bool is_cosine = type.metric == DescriptorMetric::cosine;
  switch (type.kind) {
    case DescriptorKind::binary:
      if (units_ == 1)
        use<Bits256>(level);
      else
        use<Bits>(level);
      break;
    case DescriptorKind::float32:
      if (is_cosine)
        use<FloatCosine>(level);
      else
        use<FloatEuclidean>(level);
      break;
    case DescriptorKind::int8:
      if (is_cosine)
        use<Int8Cosine>(level);
      else
        use<Int8Euclidean>(level);
      break;
  }
  HOLDFAST_CHECK(two_ != nullptr, "descriptor kind " << static_cast<int>(type.kind));
}

}  // namespace holdfast
