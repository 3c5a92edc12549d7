// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/renderer.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "holdfast/core/error.hpp"
#include "visibility.hpp"

namespace holdfast::simulation {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {
constexpr double samples_per_pixel = 2.0;

RayGrid ray_grid(const Camera& camera) {
  Vector2d low, high;
  camera.undistorted_bounds(low, high);
  // A margin for the nine samples, and so that without distortion pixel centres are samples.
  low = (low.array() - 2.0).floor(), high = (high.array() + 2.0).ceil();
  RayGrid grid;
  grid.columns = static_cast<int>((high.x() - low.x()) * samples_per_pixel) + 1;
  grid.rows = static_cast<int>((high.y() - low.y()) * samples_per_pixel) + 1;
  grid.x0 = (low.x() - camera.cx) / camera.fx, grid.y0 = (low.y() - camera.cy) / camera.fy;
  grid.step_x = 1.0 / (samples_per_pixel * camera.fx), grid.step_y = 1.0 / (samples_per_pixel * camera.fy);
  return grid;
}

// Base-2 logarithm with an error below 0.01: enough to choose a mip level.
float quick_log2(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const auto mantissa = std::bit_cast<float>((bits & 0x7fffffU) | 0x3f800000U);
  return static_cast<float>(static_cast<int>(bits >> 23) - 127) + (-0.34484843F * mantissa + 2.02466578F) * mantissa -
         1.67487759F;
}
}  // namespace

struct Renderer::Buffers {
  struct PixelRay {
    float x, y;            // the ray (x, y, 1) of a raw pixel
    float inverse_length;  // 1 / |(x, y, 1)|
    std::int32_t sample;   // nearest sample of the grid: column + row * columns
  };

  Buffers(const World& rendered, const Camera& camera) : world(rendered), visibility(ray_grid(camera)) {
    const RayGrid& grid = visibility.grid();
    rays.reserve(static_cast<std::size_t>(camera.width) * camera.height);
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const Vector2d pixel = camera.undistort({x, y});
        const Vector3d ray = camera.back_project(pixel.x(), pixel.y(), 1.0);
        const auto column = std::clamp<long>(std::lround((ray.x() - grid.x0) / grid.step_x), 1, grid.columns - 2);
        const auto row = std::clamp<long>(std::lround((ray.y() - grid.y0) / grid.step_y), 1, grid.rows - 2);
        rays.push_back({static_cast<float>(ray.x()), static_cast<float>(ray.y()), static_cast<float>(1.0 / ray.norm()),
                        static_cast<std::int32_t>(row * grid.columns + column)});
      }
  }

  PosedWorld world;
  VisibilityBuffer visibility;
  std::vector<PixelRay> rays;
};

namespace {
struct Colour {
  float blue = 0, green = 0, red = 0;
};

// Colour of a triangle where the ray (x, y, 1) meets it. Footprints that are longer than wide take up to four samples
// along their length (anisotropic filtering), so that desks and floors seen flat stay sharp.
Colour colour_of(const VisibleTriangle& triangle, float x, float y, float inverse_depth, float pixel_x, float pixel_y) {
  const float depth = 1.0F / inverse_depth;
  const auto at = [&](const Vector3f& gradient) {
    return (gradient.x() * x + gradient.y() * y + gradient.z()) * depth;
  };
  const float u = at(triangle.u), v = at(triangle.v), light = at(triangle.light);
  const auto slope_x = static_cast<float>(triangle.inverse_depth.x());
  const auto slope_y = static_cast<float>(triangle.inverse_depth.y());
  const float scale_x = depth * pixel_x, scale_y = depth * pixel_y;
  const float du_dx = (triangle.u.x() - u * slope_x) * scale_x, dv_dx = (triangle.v.x() - v * slope_x) * scale_x;
  const float du_dy = (triangle.u.y() - u * slope_y) * scale_y, dv_dy = (triangle.v.y() - v * slope_y) * scale_y;
  const float across2 = du_dx * du_dx + dv_dx * dv_dx, down2 = du_dy * du_dy + dv_dy * dv_dy;
  const bool lies = across2 > down2;
  const float major2 = std::max({across2, down2, 1e-12F}), minor2 = std::max(std::min(across2, down2), 1e-12F);

  int taps = 1;
  for (float ratio2 = major2 / minor2; taps < 4 && ratio2 > 2.25F * static_cast<float>(taps * taps);) ++taps;
  constexpr float blur = 0.4F;  // of a lens, on top of that of trilinear filtering [mip levels]
  const float level = 0.5F * quick_log2(major2) - (taps > 1 ? quick_log2(static_cast<float>(taps)) : 0.0F) + blur;
  std::uint64_t sum = 0;
  for (int tap = 0; tap < taps; ++tap) {
    const float share = (static_cast<float>(tap) + 0.5F) / static_cast<float>(taps) - 0.5F;
    sum += triangle.texture->sample(u + share * (lies ? du_dx : du_dy), v + share * (lies ? dv_dx : dv_dy), level);
  }
  const float scale = light / static_cast<float>(taps);
  return {scale * static_cast<float>(sum & 0xffff), scale * static_cast<float>((sum >> 16) & 0xffff),
          scale * static_cast<float>(sum >> 32)};
}

// The mean colour of the nine samples around a pixel, weighted as a tent. Samples on the pixel's own surface have its
// colour `own`: a smooth surface is shaded once.
Colour smooth_edges(const VisibilityBuffer& visibility, std::int32_t sample, const Colour& own, float pixel_x,
                    float pixel_y) {
  constexpr std::uint32_t nothing = VisibilityBuffer::nothing;
  static constexpr int weights[9] = {1, 2, 1, 2, 4, 2, 1, 2, 1};
  const RayGrid& grid = visibility.grid();
  const std::uint32_t* centre = visibility.row(0) + sample;
  const std::uint32_t *above = centre - grid.columns, *below = centre + grid.columns;
  const std::uint32_t around[9] = {above[-1], above[0],  above[1], centre[-1], centre[0],
                                   centre[1], below[-1], below[0], below[1]};
  std::uint32_t difference = 0;
  for (const std::uint32_t number : around) difference |= number ^ centre[0];
  if (difference == 0) return own;

  const std::vector<VisibleTriangle>& triangles = visibility.triangles();
  std::uint32_t surfaces[9];
  for (int k = 0; k < 9; ++k) surfaces[k] = around[k] == nothing ? nothing : triangles[around[k]].surface;
  difference = 0;
  for (const std::uint32_t surface : surfaces) difference |= surface ^ surfaces[4];
  if (difference == 0) return own;

  Colour blend;
  int counted = 0;  // bit k: sample k
  for (int k = 0; k < 9; ++k) {
    if (counted & (1 << k)) continue;
    int weight = 0;
    for (int other = k; other < 9; ++other)
      if (surfaces[other] == surfaces[k]) weight += weights[other], counted |= 1 << other;
    if (surfaces[k] == nothing) continue;
    Colour part = own;
    if (surfaces[k] != surfaces[4]) {
      const std::int32_t there = sample + (k / 3 - 1) * grid.columns + k % 3 - 1;
      const auto x = static_cast<float>(grid.x0 + there % grid.columns * grid.step_x);
      const auto y = static_cast<float>(grid.y0 + there / grid.columns * grid.step_y);
      part = colour_of(triangles[around[k]], x, y, visibility.inverse_depths(0)[there], pixel_x, pixel_y);
    }
    const float share = static_cast<float>(weight) / 16.0F;
    blend.blue += share * part.blue, blend.green += share * part.green, blend.red += share * part.red;
  }
  return blend;
}

std::uint8_t to_byte(float value) { return static_cast<std::uint8_t>(std::min(value + 0.5F, 255.0F)); }
}  // namespace

Renderer::Renderer(const World& world, const Camera& camera)
    : camera_(camera), buffers_(std::make_unique<Buffers>(world, camera)) {
  HOLDFAST_CHECK(world.objects.size() < 65535, "objects " << world.objects.size());
}

Renderer::~Renderer() = default;

RenderedFrame Renderer::render(const Eigen::Isometry3d& T_world_camera, double time) {
  buffers_->world.pose(time);
  buffers_->visibility.draw(buffers_->world, T_world_camera);
  RenderedFrame frame;
  frame.colour.create(camera_.height, camera_.width, CV_8UC3);
  frame.depth.create(camera_.height, camera_.width, CV_32FC1);
  frame.object_ids.create(camera_.height, camera_.width, CV_16UC1);
  frame.cosine.create(camera_.height, camera_.width, CV_32FC1);
  shade(frame);
  return frame;
}

void Renderer::shade(RenderedFrame& frame) const {
  const VisibilityBuffer& visibility = buffers_->visibility;
  const std::vector<VisibleTriangle>& triangles = visibility.triangles();
  const auto pixel_x = static_cast<float>(1.0 / camera_.fx), pixel_y = static_cast<float>(1.0 / camera_.fy);

  for (int y = 0; y < camera_.height; ++y) {
    auto* colour = frame.colour.ptr<std::uint8_t>(y);
    auto* depth = frame.depth.ptr<float>(y);
    auto* object = frame.object_ids.ptr<std::uint16_t>(y);
    auto* cosine = frame.cosine.ptr<float>(y);
    const Buffers::PixelRay* ray = buffers_->rays.data() + static_cast<std::size_t>(y) * camera_.width;
    for (int x = 0; x < camera_.width; ++x, ++ray, colour += 3) {
      const std::uint32_t* centre = visibility.row(0) + ray->sample;
      const std::uint32_t number = *centre;
      Colour sum;
      if (number != VisibilityBuffer::nothing) {
        const VisibleTriangle& triangle = triangles[number];
        // The nearest sample is up to a quarter pixel off: on a surface seen almost edge-on the ray may miss it.
        const double sampled = visibility.inverse_depths(0)[ray->sample];
        const double exact =
            triangle.inverse_depth.x() * ray->x + triangle.inverse_depth.y() * ray->y + triangle.inverse_depth.z();
        const double inverse_depth = std::clamp(exact, 0.97 * sampled, 1.03 * sampled);
        depth[x] = static_cast<float>(1.0 / inverse_depth);
        object[x] = triangle.object;
        cosine[x] = static_cast<float>(inverse_depth) * triangle.inverse_norm * ray->inverse_length;
        sum = colour_of(triangle, ray->x, ray->y, static_cast<float>(inverse_depth), pixel_x, pixel_y);
      } else {
        depth[x] = 0.0F, object[x] = 0, cosine[x] = 0.0F;
      }

      sum = smooth_edges(visibility, ray->sample, sum, pixel_x, pixel_y);
      colour[0] = to_byte(sum.blue), colour[1] = to_byte(sum.green), colour[2] = to_byte(sum.red);
    }
  }
}

}  // namespace holdfast::simulation
