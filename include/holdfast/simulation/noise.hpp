// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "holdfast/core/random.hpp"

namespace holdfast::simulation {

/// Grey values of a texture under construction, row by row.
struct NoiseField {
  NoiseField(int field_width, int field_height, float value = 0.0F)
      : width(field_width), height(field_height), values(static_cast<std::size_t>(width) * height, value) {}
  float* row(int y) { return values.data() + static_cast<std::size_t>(y) * width; }
  const float* row(int y) const { return values.data() + static_cast<std::size_t>(y) * width; }

  int width;
  int height;
  std::vector<float> values;
};

/// Adds value noise (Perlin 1985, with random values instead of gradients): random numbers in [-amplitude, amplitude]
/// on a lattice of cell_x by cell_y texels, interpolated by smoothstep. It does not repeat within the field.
void add_value_noise(NoiseField& field, float cell_x, float cell_y, float amplitude, Random random);

/// Adds octaves of value noise, each with half the cell size and `gain` times the amplitude of the previous one.
void add_fractal_noise(NoiseField& field, float cell_x, float cell_y, float amplitude, int octaves, float gain,
                       const Random& random);

/// An approximately normal number (mean 0, standard deviation 1, absolute value at most 3.47) from the four bytes of
/// `bits` by the central limit theorem. It is a hundred times cheaper than an exact one, for noise on every pixel.
inline float quick_normal(std::uint32_t bits) {
  const std::uint32_t sum = (bits & 0xff) + ((bits >> 8) & 0xff) + ((bits >> 16) & 0xff) + (bits >> 24);
  constexpr float inverse_deviation = 1.0F / 147.8005F;  // of the sum: sqrt(4 (256^2 - 1) / 12)
  return (static_cast<float>(sum) - 510.0F) * inverse_deviation;
}

}  // namespace holdfast::simulation
