// SPDX-License-Identifier: BSD-3-Clause
#include "pictures_folds.hpp"

#include <algorithm>
#include <cmath>

namespace holdfast::simulation::pictures {

namespace {
// A bell of height 1 that is 0 beyond 1.
float bell(float x) {
  const float rest = 1.0F - x * x;
  return rest > 0.0F ? rest * rest : 0.0F;
}
}  // namespace

void Shade::fold(cv::Point2f from, cv::Point2f to, float bow, float width, float strength) {
  const cv::Point2f way = to - from;
  const float length = std::max(1.0F, std::sqrt(way.x * way.x + way.y * way.y));
  const cv::Point2f along(way.x / length, way.y / length), across(-along.y, along.x);
  const float reach = 2.0F * width + std::abs(bow) * length;
  const int top = std::max(0, static_cast<int>(std::min(from.y, to.y) - reach));
  const int bottom = std::min(field_.height - 1, static_cast<int>(std::max(from.y, to.y) + reach));
  const int left = static_cast<int>(std::floor(std::min(from.x, to.x) - reach));
  const int right = std::min(left + field_.width - 1, static_cast<int>(std::max(from.x, to.x) + reach));
  for (int y = top; y <= bottom; ++y) {
    float* row = field_.row(y);
    for (int x = left; x <= right; ++x) {
      const float dx = static_cast<float>(x) - from.x, dy = static_cast<float>(y) - from.y;
      const float t = (dx * along.x + dy * along.y) / length;
      if (t <= 0.0F || t >= 1.0F) continue;
      const float s = (dx * across.x + dy * across.y - 4.0F * bow * length * t * (1.0F - t)) / width;
      if (s < -1.0F || s > 2.0F) continue;
      const float taper = std::min(1.0F, 6.0F * t * (1.0F - t));
      const int column = ((x % field_.width) + field_.width) % field_.width;
      row[column] += strength * taper * (0.75F * bell((s - 0.85F) / 1.1F) - bell(s < 0.0F ? s * 1.4F : s));
    }
  }
}

void Shade::folds(const Folding& folding, Random random) {
  for (int i = 0; i < folding.count; ++i) {
    const auto down = static_cast<float>(random.uniform()), along = static_cast<float>(random.uniform());
    const cv::Point2f centre(folding.area.x + along * folding.area.width, folding.area.y + down * folding.area.height);
    const double angle = folding.direction + folding.spread * random.uniform(-1.0, 1.0);
    const double half = 0.5 * folding.length * random.uniform(0.5, 1.5);
    const cv::Point2f way(static_cast<float>(half * std::cos(angle)), static_cast<float>(half * std::sin(angle)));
    const float side = random.uniform() < 0.5 ? -1.0F : 1.0F;  // which flank is lit
    const auto strength = static_cast<float>(folding.strength * random.uniform(0.45, 1.2)),
               width = static_cast<float>(folding.width * random.uniform(0.6, 1.5)),
               bow = static_cast<float>(random.uniform(-0.12, 0.12));
    fold(centre - side * way, centre + side * way, bow, width, strength);
  }
}

void Shade::spot(cv::Point2f centre, float radius_x, float radius_y, float strength) {
  const int top = std::max(0, static_cast<int>(centre.y - radius_y));
  const int bottom = std::min(field_.height - 1, static_cast<int>(centre.y + radius_y));
  for (int y = top; y <= bottom; ++y)
    for (int x = static_cast<int>(std::floor(centre.x - radius_x)); x <= static_cast<int>(centre.x + radius_x); ++x) {
      const float dx = (static_cast<float>(x) - centre.x) / radius_x,
                  dy = (static_cast<float>(y) - centre.y) / radius_y;
      const float rest = 1.0F - dx * dx - dy * dy;
      if (rest > 0.0F) field_.row(y)[((x % field_.width) + field_.width) % field_.width] -= strength * rest * rest;
    }
}

void Shade::uneven(float cell_x, float cell_y, float amplitude, int octaves, const Random& random) {
  const int overlap = field_.width / 5;
  NoiseField wide(field_.width + overlap, field_.height);
  add_fractal_noise(wide, cell_x, cell_y, amplitude, octaves, 0.7F, random);
  for (int y = 0; y < field_.height; ++y)
    for (int x = 0; x < field_.width; ++x) {
      const float share = std::min(1.0F, static_cast<float>(x) / static_cast<float>(overlap));
      const float beyond = x < overlap ? wide.row(y)[field_.width + x] : 0.0F;
      field_.row(y)[x] += share * wide.row(y)[x] + (1.0F - share) * beyond;
    }
}

void Shade::apply(cv::Mat& picture) const {
  for (int y = 0; y < picture.rows; ++y) {
    const float* shade = field_.row(y);
    auto* out = picture.ptr<std::uint8_t>(y);
    for (int x = 0; x < picture.cols; ++x, out += 3) {
      const float factor = std::max(0.12F, 1.0F + shade[x]);
      for (int channel = 0; channel < 3; ++channel)
        out[channel] = static_cast<std::uint8_t>(std::min(static_cast<float>(out[channel]) * factor + 0.5F, 255.0F));
    }
  }
}

cv::Mat joined(const cv::Mat& picture, int overlap) {
  const int width = picture.cols - overlap;
  cv::Mat result = picture.colRange(0, width).clone();
  for (int y = 0; y < picture.rows; ++y) {
    const auto* beyond = picture.ptr<std::uint8_t>(y) + 3 * width;
    auto* out = result.ptr<std::uint8_t>(y);
    for (int i = 0; i < 3 * overlap; ++i) {
      const int share = 256 * (i / 3) / overlap;
      out[i] = static_cast<std::uint8_t>((beyond[i] * (256 - share) + out[i] * share) >> 8);
    }
  }
  return result;
}

cv::Scalar mix(const cv::Scalar& a, const cv::Scalar& b, double t) { return a * (1.0 - t) + b * t; }

}  // namespace holdfast::simulation::pictures
