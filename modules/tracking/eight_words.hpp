// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstring>

#define HOLDFAST_INLINE __attribute__((always_inline)) static inline

// Functions that return vectors are always inlined, so that none is called with another set of instructions.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace holdfast {

/// Words of 16 bits, with which compilers compute at once, by the instructions of the function into which a kernel is
/// inlined. Every processor has instructions for eight.
using EightWords = std::int16_t __attribute__((vector_size(16)));
using SixteenWords = std::int16_t __attribute__((vector_size(32)));
using ThirtyTwoWords = std::int16_t __attribute__((vector_size(64)));

/// Four words, and the fractional numbers for which every processor has instructions.
using FourWords = std::int16_t __attribute__((vector_size(8)));
using FourFloats = float __attribute__((vector_size(16)));

/// As many bytes, unsigned words, whole numbers and fractional ones. (GCC 12 ignores the size of an alias that depends
/// on a parameter, but not that of a typedef.)
template <class Words>
struct LanesOf {
  static constexpr int count = sizeof(Words) / sizeof(std::int16_t);
  typedef std::uint8_t Bytes __attribute__((vector_size(count)));
  typedef std::uint16_t Unsigned __attribute__((vector_size(count * sizeof(std::uint16_t))));
  typedef std::int32_t Integers __attribute__((vector_size(count * sizeof(std::int32_t))));
  typedef float Floats __attribute__((vector_size(count * sizeof(float))));
};

template <class Lanes, class Value>
HOLDFAST_INLINE Lanes lanes_at(const Value* values) {
  static_assert(sizeof(Lanes{}[0]) == sizeof(Value));
  Lanes lanes;
  std::memcpy(&lanes, values, sizeof lanes);
  return lanes;
}

template <class Lanes, class Value>
HOLDFAST_INLINE void store(const Lanes& lanes, Value* values) {
  static_assert(sizeof(Lanes{}[0]) == sizeof(Value));
  std::memcpy(values, &lanes, sizeof lanes);
}

/// As many neighbouring pixels as there are words.
template <class Words = EightWords>
HOLDFAST_INLINE Words pixels_at(const std::uint8_t* pixels) {
  return __builtin_convertvector(lanes_at<typename LanesOf<Words>::Bytes>(pixels), Words);
}

template <class Words>
HOLDFAST_INLINE Words absolute(const Words& values) {
  return values < 0 ? -values : values;
}

}  // namespace holdfast
