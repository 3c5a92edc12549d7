// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/sensor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "holdfast/core/random.hpp"
#include "holdfast/simulation/noise.hpp"

namespace holdfast::simulation {

namespace {
constexpr float projector_baseline = 0.075F;   // of a Kinect [m]
constexpr float kinect_focal_length = 580.0F;  // of its infrared camera [px]
constexpr float disparity_step = 0.125F;       // [px]

// The angular term of Nguyen et al. by cosine of incidence, without its 1 / sqrt(z).
std::array<float, 257> angular_noise() {
  std::array<float, 257> table{};
  for (int i = 0; i <= 256; ++i) {
    const double angle = std::min(std::acos(i / 256.0), 1.4);
    table[i] = static_cast<float>(0.0001 * std::pow(angle / (std::numbers::pi / 2 - angle), 2.0));
  }
  return table;
}

// Marks the pixels of a row that the projector does not light: it stands to the right of the camera, so a point at
// column x with disparity d is column x - d to it, and what falls behind something nearer is hidden.
void mark_shadow(const float* depth, int width, float focal_length_baseline, std::uint8_t* hole) {
  float leftmost = std::numeric_limits<float>::infinity();
  for (int x = width - 1; x >= 0; --x) {
    if (depth[x] <= 0.0F) continue;
    const float column = static_cast<float>(x) - focal_length_baseline / depth[x];
    if (column > leftmost + 0.5F) hole[x] = 1;
    leftmost = std::min(leftmost, column);
  }
}
}  // namespace

cv::Mat sense_depth(const cv::Mat& depth, const cv::Mat& cosine, const Camera& camera,
                    const DepthSensorSettings& settings, std::uint64_t seed) {
  static const std::array<float, 257> angular = angular_noise();
  cv::Mat sensed(depth.size(), CV_32FC1);
  const auto nearest = static_cast<float>(settings.minimum_depth),
             farthest = static_cast<float>(settings.maximum_depth);
  const auto noise = static_cast<float>(settings.noise);
  const auto shadow_scale = static_cast<float>(camera.fx) * projector_baseline;
  constexpr float disparity_scale = kinect_focal_length * projector_baseline / disparity_step;
  const Random base(seed);
  std::vector<std::uint8_t> hole(depth.cols);

  for (int y = 0; y < depth.rows; ++y) {
    Random random = base.fork(static_cast<std::uint64_t>(y));
    const float* in = depth.ptr<float>(y);
    const float* above = depth.ptr<float>(std::max(y - 1, 0));
    const float* below = depth.ptr<float>(std::min(y + 1, depth.rows - 1));
    const float* facing = cosine.ptr<float>(y);
    float* out = sensed.ptr<float>(y);
    std::fill(hole.begin(), hole.end(), 0);
    if (settings.holes) mark_shadow(in, depth.cols, shadow_scale, hole.data());

    for (int x = 0; x < depth.cols; ++x) {
      const std::uint64_t bits = random.next();
      float z = in[x];
      out[x] = 0.0F;
      if (z < nearest || z > farthest || hole[x]) continue;
      if (settings.holes) {
        const float* const rows[3] = {above, in, below};
        const auto choice = static_cast<std::uint32_t>(bits >> 32 & 0xffff);
        const int column = std::clamp(x + static_cast<int>((choice & 0xff) % 3) - 1, 0, depth.cols - 1);
        const float other = rows[(choice >> 8) % 3][column];
        // Surfaces seen flat change depth from pixel to pixel too: their own slope is no edge.
        const float slope = std::max(0.02F, 0.004F / std::max(facing[x], 0.05F));
        if (std::abs(other - z) > slope * z) continue;
        const float flat = (0.21F - facing[x]) / 0.15F;
        if (static_cast<float>(bits >> 48) * 0x1.0p-16F < flat) continue;
      }
      const float step = z * z / disparity_scale;
      if (noise > 0.0F) {
        const float away = z - 0.4F;
        const float deviation =
            noise * (0.0012F + 0.0019F * away * away +
                     angular[static_cast<int>(std::clamp(facing[x], 0.0F, 1.0F) * 256.0F)] / std::sqrt(z));
        const float rounding2 = settings.quantisation ? step * step / 12.0F : 0.0F;
        z += quick_normal(static_cast<std::uint32_t>(bits)) *
             std::sqrt(std::max(0.0F, deviation * deviation - rounding2));
      }
      if (settings.quantisation && z > 0.0F) {
        z = disparity_scale / static_cast<float>(static_cast<int>(disparity_scale / z + 0.5F));
      }
      if (z >= nearest && z <= farthest) out[x] = z;
    }
  }
  return sensed;
}

void add_colour_noise(cv::Mat& colour, const ColourSensorSettings& settings, std::uint64_t seed) {
  if (settings.noise <= 0.0) return;
  const auto deviation = static_cast<float>(settings.noise);
  const Random base(seed);
  for (int y = 0; y < colour.rows; ++y) {
    Random random = base.fork(static_cast<std::uint64_t>(y));
    auto* values = colour.ptr<std::uint8_t>(y);
    const int count = 3 * colour.cols;
    for (int i = 0; i < count; i += 2) {
      const std::uint64_t bits = random.next();
      for (int k = 0; k < 2 && i + k < count; ++k) {
        const float value =
            static_cast<float>(values[i + k]) + deviation * quick_normal(static_cast<std::uint32_t>(bits >> (32 * k)));
        values[i + k] = static_cast<std::uint8_t>(std::clamp(value + 0.5F, 0.0F, 255.0F));
      }
    }
  }
}

}  // namespace holdfast::simulation
