// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "holdfast/simulation/sensor.hpp"
#include "row_random.hpp"

namespace holdfast::simulation {

namespace {
// Grey levels with sixteen bits behind the point.
constexpr int one = 1 << 16;

// Pseudo-random in [0.5, 1], for the size of a swing.
double swing(const Random& random, double number) {
  const double size = random.fork(static_cast<std::uint64_t>(static_cast<std::int64_t>(number))).uniform(0.5, 1.0);
  return std::fmod(number, 2.0) == 0.0 ? size : -size;
}
}  // namespace

double exposure_gain(const ColourSensorSettings& settings, std::uint64_t seed, double time) {
  if (settings.exposure_change <= 0.0 || settings.exposure_period <= 0.0) return 1.0;
  // Swings up and down in turn, joined by smoothstep, from a random phase.
  Random random = Random(seed).fork(0x6a19);
  const double position = 2.0 * time / settings.exposure_period + random.uniform(0.0, 2.0);
  const double number = std::floor(position), t = position - number;
  const double from = swing(random, number), to = swing(random, number + 1.0);
  const double change = settings.exposure_change * (from + t * t * (3.0 - 2.0 * t) * (to - from));
  return change >= 0.0 ? 1.0 + change : 1.0 / (1.0 - change);
}

void sense_colour(cv::Mat& colour, const ColourSensorSettings& settings, std::uint64_t seed, double time, double gain) {
  const double total = std::clamp(gain * exposure_gain(settings, seed, time), 0.0, 64.0);
  const bool scaled = total != 1.0 || settings.vignetting > 0.0;
  if (!scaled && settings.noise <= 0.0) return;
  const Random frame = Random(seed).fork(std::bit_cast<std::uint64_t>(time)).fork(0xc010);
  const auto noise_scale = static_cast<std::int32_t>(std::lround(settings.noise / byte_sum_deviation * one));
  const int count = 3 * colour.cols;
  const double middle_x = 0.5 * (colour.cols - 1), middle_y = 0.5 * (colour.rows - 1);
  const double corner2 = std::max(1.0, middle_x * middle_x + middle_y * middle_y);
  std::vector<std::int32_t> noise((count + 3) / 4 * 4, 0), gains(count, one);

  for (int y = 0; y < colour.rows; ++y) {
    auto* values = colour.ptr<std::uint8_t>(y);
    if (settings.noise > 0.0) {
      RowRandom random(frame.fork(static_cast<std::uint64_t>(y)));
      for (std::size_t i = 0; i < noise.size(); i += 4) store(&noise[i], byte_sums(random.next()) * noise_scale);
    }
    if (settings.vignetting > 0.0 || (scaled && y == 0)) {
      const double down2 = (y - middle_y) * (y - middle_y);
      for (int x = 0; x < colour.cols; ++x) {
        const double radius2 = ((x - middle_x) * (x - middle_x) + down2) / corner2;
        const double here = total * std::max(0.0, 1.0 - settings.vignetting * radius2);
        std::fill_n(&gains[3 * x], 3, static_cast<std::int32_t>(here * one));
      }
    }
    if (scaled) {
      for (int i = 0; i < count; ++i) {
        const std::int32_t value = values[i] * gains[i] + noise[i] + one / 2;
        values[i] = static_cast<std::uint8_t>(std::clamp(value >> 16, 0, 255));
      }
    } else {
      for (int i = 0; i < count; ++i) {
        const std::int32_t value = values[i] * one + noise[i] + one / 2;
        values[i] = static_cast<std::uint8_t>(std::clamp(value >> 16, 0, 255));
      }
    }
  }
}

}  // namespace holdfast::simulation
