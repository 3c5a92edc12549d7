// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <limits>

#include "holdfast/core/descriptor.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast {
namespace {

constexpr DescriptorType floats{DescriptorKind::float32, DescriptorMetric::euclidean, 5, 1.0F, 2.0F};

TEST(DescriptorBlock, IsOf256BitsUnlessToldOtherwise) {
  DescriptorBlock block;
  EXPECT_EQ(block.size(), 0U);
  block.resize(3);
  EXPECT_EQ(block.size(), 3U);
  EXPECT_EQ(block.of_256_bits().size(), 3U);
  EXPECT_EQ(block.of_256_bits()[2], Descriptor256());
  EXPECT_EQ(block.type(), DescriptorType());
}

TEST(DescriptorBlock, RowsAreAlignedAndPaddedWithZeros) {
  DescriptorBlock block(floats, 4);
  for (std::size_t i = 0; i < block.size(); ++i) {
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(block.row(i)) % 32, 0U);
    ASSERT_EQ(block.numbers(i).size(), 5U);
    for (float& number : block.numbers(i)) number = static_cast<float>(i) + 1.0F;
  }
  const DescriptorView view = block;
  EXPECT_EQ(view.units(), 1U);
  for (std::size_t i = 0; i < block.size(); ++i)
    for (std::size_t byte = 20; byte < 32; ++byte)
      EXPECT_EQ(reinterpret_cast<const std::uint8_t*>(view.row(i))[byte], 0) << "padding";
}

TEST(DescriptorBlock, AppendedToNothingItTakesTheType) {
  DescriptorBlock all(floats, 3);
  all.numbers(1)[4] = 7.0F;
  DescriptorBlock some;
  some.append(all, 1);
  some.append(all, 0);
  EXPECT_EQ(some.type(), floats);
  ASSERT_EQ(some.size(), 2U);
  EXPECT_EQ(some.numbers(0)[4], 7.0F);
  EXPECT_EQ(some.numbers(1)[4], 0.0F);
  EXPECT_TRUE(some.view() == some.view());
  EXPECT_TRUE(some.view() == all.view().subview(1, 2));
  EXPECT_FALSE(some.view() == all.view().subview(0, 2));
}

TEST(DescriptorBlock, KeepsTypesApart) {
  DescriptorBlock bits({}, 2), numbers(floats, 2);
  EXPECT_THROW(bits.append(numbers, 0), CheckError);
  EXPECT_THROW(numbers.append(bits, 0), CheckError);
  EXPECT_THROW(numbers.of_256_bits(), CheckError);
  EXPECT_THROW(bits.numbers(0), CheckError);
  DescriptorType other_limits = floats;
  other_limits.loose_distance = 9.0F;
  DescriptorBlock comparable(other_limits, 1);
  EXPECT_NO_THROW(numbers.append(comparable, 0)) << "recommended distances may differ";
}

TEST(DescriptorType, ImpossibleOnesAreNamed) {
  const auto trouble = [](auto&& change) {
    DescriptorType type;
    change(type);
    return trouble_of(type);
  };
  EXPECT_EQ(trouble([](DescriptorType&) {}), "");
  EXPECT_EQ(trouble_of(floats), "");
  EXPECT_NE(trouble([](DescriptorType& type) { type.length = 0; }), "");
  EXPECT_NE(trouble([](DescriptorType& type) { type.length = 1U << 20; }), "");
  EXPECT_NE(trouble([](DescriptorType& type) { type.metric = DescriptorMetric::euclidean; }), "");
  EXPECT_NE(trouble([](DescriptorType& type) { type.kind = DescriptorKind::float32; }), "");
  EXPECT_NE(trouble([](DescriptorType& type) { type.strict_distance = 0.0F; }), "");
  EXPECT_NE(trouble([](DescriptorType& type) { type.loose_distance = 10.0F; }), "");
  EXPECT_NE(trouble([](DescriptorType& type) { type.loose_distance = std::numeric_limits<float>::infinity(); }), "");
  EXPECT_THROW(DescriptorBlock({DescriptorKind::float32, DescriptorMetric::hamming, 5, 1, 2}), CheckError);
}

TEST(DescriptorType, TextNamesLengthKindAndMetric) {
  EXPECT_EQ(to_string(DescriptorType()), "256 bits (hamming)");
  EXPECT_EQ(to_string(floats), "5 float32 (euclidean)");
}

TEST(DistanceLimit, ZeroMeansTheRecommendedOne) {
  EXPECT_EQ(distance_limit(0.0, 50.0F), 50.0F);
  EXPECT_EQ(distance_limit(40.0, 50.0F), 40.0F);
  EXPECT_EQ(DescriptorType().distance_between(0.5F), 75.0F);
  EXPECT_EQ(DescriptorType().distance_between(0.2F), 60.0F);
}

}  // namespace
}  // namespace holdfast
