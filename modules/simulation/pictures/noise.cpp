// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/noise.hpp"

#include <algorithm>
#include <cmath>

namespace holdfast::simulation {

namespace {
struct Tap {
  int cell;
  float weight;
};

std::vector<Tap> taps(int count, float cell_size, float phase) {
  std::vector<Tap> result(count);
  for (int i = 0; i < count; ++i) {
    const float position = static_cast<float>(i) / cell_size + phase;
    const int cell = static_cast<int>(position);
    const float t = position - static_cast<float>(cell);
    result[i] = {cell, t * t * (3.0F - 2.0F * t)};
  }
  return result;
}
}  // namespace

void add_value_noise(NoiseField& field, float cell_x, float cell_y, float amplitude, Random random) {
  cell_x = std::max(cell_x, 1.0F), cell_y = std::max(cell_y, 1.0F);
  const auto columns = taps(field.width, cell_x, static_cast<float>(random.uniform()));
  const auto rows = taps(field.height, cell_y, static_cast<float>(random.uniform()));
  const int lattice_width = columns.back().cell + 2, lattice_height = rows.back().cell + 2;
  std::vector<float> lattice(static_cast<std::size_t>(lattice_width) * lattice_height);
  for (float& value : lattice) value = amplitude * static_cast<float>(random.uniform(-1.0, 1.0));

  std::vector<float> between(lattice_width);
  for (int y = 0; y < field.height; ++y) {
    const float* above = lattice.data() + static_cast<std::size_t>(rows[y].cell) * lattice_width;
    const float* below = above + lattice_width;
    for (int i = 0; i < lattice_width; ++i) between[i] = above[i] + rows[y].weight * (below[i] - above[i]);
    float* out = field.row(y);
    for (int x = 0; x < field.width; ++x) {
      const float* left = between.data() + columns[x].cell;
      out[x] += left[0] + columns[x].weight * (left[1] - left[0]);
    }
  }
}

void add_fractal_noise(NoiseField& field, float cell_x, float cell_y, float amplitude, int octaves, float gain,
                       const Random& random) {
  for (int octave = 0; octave < octaves; ++octave) {
    add_value_noise(field, cell_x, cell_y, amplitude, random.fork(static_cast<std::uint64_t>(octave) + 1));
    cell_x *= 0.5F, cell_y *= 0.5F, amplitude *= gain;
  }
}

}  // namespace holdfast::simulation
