// SPDX-License-Identifier: BSD-3-Clause
#include "patch_costs.hpp"

#include <cmath>
#include <cstring>

#include "eight_words.hpp"

namespace holdfast {

namespace {

constexpr int max_side = 2 * max_patch_radius + 1;
constexpr int width = 64;  // of rows in buffers: a multiple of all lanes, and what they read beyond the last shift
static_assert(max_side - 1 + max_patch_shifts <= width);

/// Rows of an image from a column on.
struct ByteRows {
  const std::uint8_t* data;
  std::ptrdiff_t step;
  const std::uint8_t* row(int k) const { return data + k * step; }
};
using ByteBuffer = std::array<std::uint8_t, static_cast<std::size_t>((max_side + 1) * width)>;

/// `rows` rows of `used` pixels, after which pixels up to `width` can be read: of the image or, near its right border,
/// copied.
ByteRows rows_of(const cv::Mat& image, int column, int first_row, int used, int rows, ByteBuffer& buffer) {
  const ByteRows shown{image.ptr<std::uint8_t>(first_row) + column, static_cast<std::ptrdiff_t>(image.step)};
  if (column + width <= image.cols) return shown;
  buffer.fill(0);
  for (int row = 0; row < rows; ++row)
    std::memcpy(buffer.data() + row * width, shown.row(row), static_cast<std::size_t>(used));
  return {buffer.data(), width};
}

/// The pixels that are compared.
struct Patches {
  ByteRows left, right;
  int part;  // [1/64] of the row below in the right image
  int side, shifts;
};

/// Rows as words, and the sums of their columns.
struct WordRows {
  alignas(64) std::array<std::array<std::int16_t, width>, max_side> rows;
  alignas(64) std::array<std::int16_t, width> sums;  // 31 times 255 at most
};

template <class Words>
HOLDFAST_INLINE void read(const ByteRows& from, int part, int used, int side, WordRows& to) {
  constexpr int lanes = LanesOf<Words>::count;
  const auto above = static_cast<std::int16_t>(64 - part), below = static_cast<std::int16_t>(part);
  for (int k = 0; k < used; k += lanes) {
    Words sum{};
    for (int row = 0; row < side; ++row) {
      Words values = pixels_at<Words>(from.row(row) + k);
      if (part != 0)
        values = (values * above + pixels_at<Words>(from.row(row + 1) + k) * below + std::int16_t{32}) >> 6;
      store(values, to.rows[static_cast<std::size_t>(row)].data() + k);
      sum += values;
    }
    store(sum, to.sums.data() + k);
  }
}

/// Mean differences of the patches, left minus right.
template <class Words>
HOLDFAST_INLINE void mean_differences(const WordRows& left, const WordRows& right, int side, int shifts,
                                      std::int16_t* means) {
  constexpr int lanes = LanesOf<Words>::count;
  using Integers = typename LanesOf<Words>::Integers;
  using Floats = typename LanesOf<Words>::Floats;
  alignas(64) std::array<std::int32_t, max_patch_shifts> differences{};
  int difference = 0;
  for (int k = 0; k < side; ++k)
    difference += left.sums[static_cast<std::size_t>(k)] - right.sums[static_cast<std::size_t>(k)];
  for (int shift = 0; shift < shifts; ++shift) {
    differences[static_cast<std::size_t>(shift)] = difference;
    if (shift + 1 < shifts)
      difference -= right.sums[static_cast<std::size_t>(shift + side)] - right.sums[static_cast<std::size_t>(shift)];
  }
  // Less than 2^18, so that the quotient of whole numbers is rounded to zero as they would be.
  const auto area = static_cast<float>(side * side);
  for (int block = 0; block < shifts; block += lanes) {
    const Floats mean = __builtin_convertvector(lanes_at<Integers>(differences.data() + block), Floats) / area;
    store(__builtin_convertvector(__builtin_convertvector(mean, Integers), Words), means + block);
  }
}

template <class Words>
HOLDFAST_INLINE void compare(const Patches& patches, int* costs) {
  constexpr int lanes = LanesOf<Words>::count;
  constexpr int most_differences = 65535 / 510;  // whose sum fits into 16 unsigned bits
  using Integers = typename LanesOf<Words>::Integers;
  using Unsigned = typename LanesOf<Words>::Unsigned;
  const int side = patches.side, shifts = patches.shifts;
  WordRows left, right;
  read<Words>(patches.left, 0, side, side, left);
  read<Words>(patches.right, patches.part, side - 1 + shifts, side, right);
  alignas(64) std::array<std::int16_t, max_patch_shifts> means;
  mean_differences<Words>(left, right, side, shifts, means.data());
  const int rows_at_once = most_differences / side;
  for (int block = 0; block < shifts; block += lanes) {
    const Words mean = lanes_at<Words>(means.data() + block);
    Integers total{};
    for (int begin = 0; begin < side; begin += rows_at_once) {
      const int end = begin + rows_at_once < side ? begin + rows_at_once : side;
      Unsigned sum{};
      for (int row = begin; row < end; ++row) {
        const std::int16_t* a = left.rows[static_cast<std::size_t>(row)].data();
        const std::int16_t* b = right.rows[static_cast<std::size_t>(row)].data() + block;
        for (int k = 0; k < side; ++k) sum += (Unsigned)absolute<Words>(a[k] - mean - lanes_at<Words>(b + k));
      }
      total += __builtin_convertvector(sum, Integers);
    }
    store(total, costs + block);
  }
}

// The same once per set of instructions.
void compare_scalar(const Patches& patches, int* costs) { compare<EightWords>(patches, costs); }
#if defined(__x86_64__)
__attribute__((target("avx2"))) void compare_avx2(const Patches& patches, int* costs) {
  compare<SixteenWords>(patches, costs);
}
__attribute__((target("avx512bw,avx512vl"))) void compare_avx512(const Patches& patches, int* costs) {
  compare<ThirtyTwoWords>(patches, costs);
}
#endif

}  // namespace

void compare_patches(const cv::Mat& left, const cv::Mat& right, const PatchSearch& search,
                     std::array<int, max_patch_shifts>& costs, [[maybe_unused]] SimdLevel level) {
  const int side = 2 * search.radius + 1;
  const int top = static_cast<int>(std::floor(search.top));
  const int part = static_cast<int>(std::lround(64.0F * (search.top - std::floor(search.top))));
  ByteBuffer left_buffer, right_buffer;
  const Patches patches{rows_of(left, search.x - search.radius, search.y - search.radius, side, side, left_buffer),
                        rows_of(right, search.first - search.radius, top, side - 1 + search.shifts,
                                part == 0 ? side : side + 1, right_buffer),
                        part, side, search.shifts};
#if defined(__x86_64__)
  if (level >= SimdLevel::avx512) return compare_avx512(patches, costs.data());
  if (level >= SimdLevel::avx2) return compare_avx2(patches, costs.data());
#endif
  compare_scalar(patches, costs.data());
}

}  // namespace holdfast
