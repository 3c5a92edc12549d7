// SPDX-License-Identifier: BSD-3-Clause
#include "slopes.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "holdfast/core/depth_noise.hpp"
#include "holdfast/core/simd.hpp"
#include "lanes.hpp"

namespace holdfast::surface {

namespace {

constexpr float smallest_cosine = 0.25F;  // of the viewing angle; closer to the rim of a surface depth says little
constexpr int reach = 3;                  // of the normal, to each side [px]

/// A row of depths, those `reach` rows above and below, and the rays of the columns, with `reach` more at the left side
/// and at least as many at the right.
struct SlopeRow {
  const float *above, *row, *below, *rays_x;
  float ray_above, ray, ray_below;
  ViewImage::Pixel* pixels;
  int width;
};

struct Vector8 {
  Float8 x, y, z;
};

/// The point of a pixel around a centre, or the centre if there is no continuation of its surface.
HOLDFAST_INLINE Vector8 point_around(const Float8& depth, const Float8& ray_x, float ray_y, const Float8& centre,
                                     const Float8& centre_ray_x, float centre_ray_y, const Float8& gap) {
  const Float8 difference = depth - centre;
  const Float8 length = difference < 0.0F ? -difference : difference;
  const Int8 is_other = (depth <= 0.0F) | (length > gap);
  const Float8 z = is_other ? centre : depth;
  return {(is_other ? centre_ray_x : ray_x) * z, (is_other ? Float8{} + centre_ray_y : Float8{} + ray_y) * z, z};
}

/// depth_noise::alignment_deviation of eight depths.
HOLDFAST_INLINE Float8 alignment_deviation(const Float8& depth) { return 0.02F + 0.01F * depth * depth; }
static_assert(depth_noise::alignment_deviation(3.0F) == 0.02F + 0.01F * 3.0F * 3.0F);

HOLDFAST_INLINE Float8 square_root(const Float8& values) {
  Float8 roots;
  for (int k = 0; k < 8; ++k) roots[k] = std::sqrt(values[k]);
  return roots;
}

/// Sets slope and weight of eight pixels from `x` on.
HOLDFAST_INLINE void set_slopes8(const SlopeRow& row, int x) {
  const Float8 centre = load8(row.row + x + reach), ray_x = load8(row.rays_x + x + reach);
  const auto& tolerance = depth_noise::continues_normal;
  const Float8 gap = static_cast<float>(reach) * (tolerance.offset + tolerance.slope * centre);
  const auto around = [&](const float* depths, const float* rays, float ray_y) __attribute__((always_inline)) {
    return point_around(load8(depths), load8(rays), ray_y, centre, ray_x, row.ray, gap);
  };
  const float* const rays = row.rays_x + x;
  const Vector8 right = around(row.row + x + 2 * reach, rays + 2 * reach, row.ray),
                left = around(row.row + x, rays, row.ray);
  const Vector8 down = around(row.below + x + reach, rays + reach, row.ray_below),
                up = around(row.above + x + reach, rays + reach, row.ray_above);
  const Vector8 a{right.x - left.x, right.y - left.y, right.z - left.z}, b{down.x - up.x, down.y - up.y, down.z - up.z};
  const Vector8 normal{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  const Float8 length = square_root(normal.x * normal.x + (normal.y * normal.y + normal.z * normal.z));
  const Float8 product = normal.x * ray_x + (normal.y * row.ray + normal.z);
  const Float8 along = (product < 0.0F ? -product : product) / length;
  const Float8 cosine = along / square_root(ray_x * ray_x + (Float8{} + row.ray * row.ray + 1.0F));
  const Float8 deviation = alignment_deviation(centre) / depth_noise::alignment_deviation(0.0F);
  const Float8 weight = 64.0F * cosine * cosine / (deviation * deviation) + 0.5F;
  for (int k = 0; k < 8 && x + k < row.width; ++k) {
    if (!(centre[k] > 0.0F) || !(length[k] > 0.0F)) continue;
    ViewImage::Pixel& pixel = row.pixels[x + k];
    pixel.slope = std::max(along[k], ViewImage::smallest_slope);
    if (pixel.depth <= 0.0F || cosine[k] < smallest_cosine) continue;
    pixel.weight = static_cast<std::uint8_t>(std::clamp(weight[k], 1.0F, 64.0F));
  }
}

// The same loop once per set of instructions.
#define HOLDFAST_SLOPES(name, target)                             \
  struct name {                                                   \
    target static void row(const SlopeRow& row) {                 \
      for (int x = 0; x < row.width; x += 8) set_slopes8(row, x); \
    }                                                             \
  };
HOLDFAST_SLOPES(ScalarSlopes, )
#if defined(__x86_64__)
HOLDFAST_SLOPES(Sse4Slopes, __attribute__((target("sse4.1"))))
HOLDFAST_SLOPES(Avx2Slopes, __attribute__((target("avx2"))))
#endif
#undef HOLDFAST_SLOPES

}  // namespace

void set_slopes(const cv::Mat& depths, const std::vector<float>& rays_x, const std::vector<float>& rays_y,
                ViewImage::Pixel* pixels) {
  constexpr int margin = reach + 7;  // so that eight pixels can always be read
  cv::Mat padded;
  cv::copyMakeBorder(depths, padded, 0, 0, reach, margin, cv::BORDER_REPLICATE);
  std::vector<float> padded_x(static_cast<std::size_t>(reach), rays_x.front());
  padded_x.insert(padded_x.end(), rays_x.begin(), rays_x.end());
  padded_x.insert(padded_x.end(), static_cast<std::size_t>(margin), rays_x.back());
  void (*row_of)(const SlopeRow&) = ScalarSlopes::row;
#if defined(__x86_64__)
  if (simd_level() >= SimdLevel::sse4) row_of = Sse4Slopes::row;
  if (simd_level() >= SimdLevel::avx2) row_of = Avx2Slopes::row;
#endif
  for (int y = 0; y < depths.rows; ++y) {
    const int above = std::max(y - reach, 0), below = std::min(y + reach, depths.rows - 1);
    const auto ray = [&](int row) { return rays_y[static_cast<std::size_t>(row)]; };
    row_of({padded.ptr<float>(above), padded.ptr<float>(y), padded.ptr<float>(below), padded_x.data(), ray(above),
            ray(y), ray(below), pixels + y * depths.cols, depths.cols});
  }
}

}  // namespace holdfast::surface
