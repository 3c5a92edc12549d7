// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/descriptor_distance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "holdfast/core/random.hpp"

namespace holdfast {
namespace {

/// Descriptors of a type with random content; those of numbers have unit length for the cosine.
DescriptorBlock random_descriptors(const DescriptorType& type, std::size_t count) {
  Random random(1);
  DescriptorBlock block(type, count);
  for (std::size_t i = 0; i < count; ++i) {
    if (type.kind != DescriptorKind::float32) {
      for (std::byte& byte : block.bytes(i)) byte = static_cast<std::byte>(random.below(256));
      if (type.kind == DescriptorKind::binary && type.length % 8 != 0)
        block.bytes(i).back() &= static_cast<std::byte>((1U << (type.length % 8)) - 1U);
      continue;
    }
    double squares = 0.0;
    for (float& number : block.numbers(i)) {
      number = static_cast<float>(random.normal());
      squares += static_cast<double>(number) * number;
    }
    if (type.metric == DescriptorMetric::cosine)
      for (float& number : block.numbers(i)) number /= static_cast<float>(std::sqrt(squares));
  }
  return block;
}

/// The distance by its definition, in double precision.
double plain_distance(const DescriptorView& descriptors, std::size_t i, std::size_t k) {
  const DescriptorType& type = descriptors.type();
  const std::span<const std::byte> a = descriptors.bytes(i), b = descriptors.bytes(k);
  if (type.kind == DescriptorKind::binary) {
    int bits = 0;
    for (std::uint32_t bit = 0; bit < type.length; ++bit)
      bits += (((a[bit / 8] ^ b[bit / 8]) >> (bit % 8)) & std::byte{1}) != std::byte{0} ? 1 : 0;
    return bits;
  }
  double squares = 0.0, product = 0.0, squares_a = 0.0, squares_b = 0.0;
  for (std::uint32_t n = 0; n < type.length; ++n) {
    const bool is_float = type.kind == DescriptorKind::float32;
    const double x = is_float ? reinterpret_cast<const float*>(a.data())[n]
                              : static_cast<double>(reinterpret_cast<const std::int8_t*>(a.data())[n]);
    const double y = is_float ? reinterpret_cast<const float*>(b.data())[n]
                              : static_cast<double>(reinterpret_cast<const std::int8_t*>(b.data())[n]);
    squares += (x - y) * (x - y), product += x * y, squares_a += x * x, squares_b += y * y;
  }
  return type.metric == DescriptorMetric::euclidean ? std::sqrt(squares)
                                                    : 1.0 - product / std::sqrt(squares_a * squares_b);
}

class DescriptorDistance : public testing::TestWithParam<DescriptorType> {};

TEST_P(DescriptorDistance, KernelsAgreeWithTheDefinition) {
  const DescriptorBlock descriptors = random_descriptors(GetParam(), 150);
  const DescriptorView view = descriptors;
  const DescriptorDistances distances(GetParam());
  const double tolerance = GetParam().kind == DescriptorKind::binary ? 0.0 : 1e-5;
  for (const std::size_t count : {0U, 1U, 3U, 64U, 65U, 150U}) {
    std::vector<std::uint32_t> candidates(count);
    for (std::size_t i = 0; i < count; ++i) candidates[i] = static_cast<std::uint32_t>((i * 7) % 150);
    std::vector<float> of_candidates(count), of_rows(count);
    descriptor_distances(view, 5, view, candidates, of_candidates.data());
    distances.of_rows(view.row(5), view.row(0), count, of_rows.data());
    for (std::size_t i = 0; i < count; ++i) {
      const double expected = plain_distance(view, 5, candidates[i]);
      EXPECT_NEAR(of_candidates[i], expected, tolerance * (1.0 + expected));
      EXPECT_EQ(of_candidates[i], distances.of_two(view.row(5), view.row(candidates[i])));
      EXPECT_NEAR(of_rows[i], plain_distance(view, 5, i), tolerance * (1.0 + of_rows[i]));
    }
  }
}

TEST_P(DescriptorDistance, HasTheSameBitsAtEverySimdLevel) {
  const DescriptorBlock descriptors = random_descriptors(GetParam(), 150);
  const DescriptorView view = descriptors;
  std::vector<float> expected(150), found(150);
  DescriptorDistances(GetParam(), SimdLevel::scalar).of_rows(view.row(5), view.row(0), 150, expected.data());
  for (const SimdLevel level : simd_levels) {
    if (!has_simd_level(level)) break;
    const DescriptorDistances distances(GetParam(), level);
    distances.of_rows(view.row(5), view.row(0), 150, found.data());
    EXPECT_EQ(std::memcmp(found.data(), expected.data(), 150 * sizeof(float)), 0) << to_string(level);
  }
}

TEST_P(DescriptorDistance, IsZeroToItself) {
  const DescriptorBlock descriptors = random_descriptors(GetParam(), 20);
  const DescriptorDistances distances(GetParam());
  for (std::size_t i = 0; i < descriptors.size(); ++i)
    EXPECT_NEAR(distances.of_two(descriptors.row(i), descriptors.row(i)), 0.0F, 1e-6F);
}

using Kind = DescriptorKind;
using Metric = DescriptorMetric;
INSTANTIATE_TEST_SUITE_P(AllTypes, DescriptorDistance,
                         testing::Values(DescriptorType{}, DescriptorType{Kind::binary, Metric::hamming, 128},
                                         DescriptorType{Kind::binary, Metric::hamming, 486},
                                         DescriptorType{Kind::binary, Metric::hamming, 512},
                                         DescriptorType{Kind::float32, Metric::euclidean, 128, 1, 2},
                                         DescriptorType{Kind::float32, Metric::euclidean, 3, 1, 2},
                                         DescriptorType{Kind::float32, Metric::cosine, 64, 1, 2},
                                         DescriptorType{Kind::float32, Metric::cosine, 257, 1, 2},
                                         DescriptorType{Kind::int8, Metric::euclidean, 128, 1, 2},
                                         DescriptorType{Kind::int8, Metric::cosine, 61, 1, 2}),
                         [](const auto& tested) {
                           return std::string(to_string(tested.param.kind)) + to_string(tested.param.metric) +
                                  std::to_string(tested.param.length);
                         });

TEST(HammingDistance, CountsEveryBit) {
  Descriptor256 none, all;
  all.words.fill(~std::uint64_t{0});
  EXPECT_EQ(hamming_distance(none, none), 0);
  EXPECT_EQ(hamming_distance(none, all), 256);
  for (int bit = 0; bit < 256; ++bit) {
    Descriptor256 one;
    one.words[static_cast<std::size_t>(bit / 64)] = std::uint64_t{1} << (bit % 64);
    EXPECT_EQ(hamming_distance(none, one), 1);
  }
}

}  // namespace
}  // namespace holdfast
