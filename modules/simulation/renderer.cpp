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

  Buffers(const Camera& camera) : visibility(ray_grid(camera)) {
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

  VisibilityBuffer visibility;
  std::vector<PixelRay> rays;
};

namespace {
struct Colour {
  float blue = 0, green = 0, red = 0;
};

// Colour of a triangle where the ray (x, y, 1) meets it. Footprints that are longer than wide take up to four samples
// along their length (anisotropic filtering), so that desks and floors seen flat stay sharp.
Colour colour_of(const VisibleTriangle& triangle, double x, double y, double inverse_depth, double pixel_x,
                 double pixel_y) {
  const double depth = 1.0 / inverse_depth;
  const auto at = [&](const Vector3d& gradient) {
    return (gradient.x() * x + gradient.y() * y + gradient.z()) * depth;
  };
  const double u = at(triangle.u), v = at(triangle.v);
  const auto light = static_cast<float>(at(triangle.light));
  const Vector3d& g = triangle.inverse_depth;
  const auto du_dx = static_cast<float>((triangle.u.x() - u * g.x()) * depth * pixel_x);
  const auto dv_dx = static_cast<float>((triangle.v.x() - v * g.x()) * depth * pixel_x);
  const auto du_dy = static_cast<float>((triangle.u.y() - u * g.y()) * depth * pixel_y);
  const auto dv_dy = static_cast<float>((triangle.v.y() - v * g.y()) * depth * pixel_y);
  const float across2 = du_dx * du_dx + dv_dx * dv_dx, down2 = du_dy * du_dy + dv_dy * dv_dy;
  const bool lies = across2 > down2;
  const float major2 = std::max({across2, down2, 1e-12F}), minor2 = std::max(std::min(across2, down2), 1e-12F);

  int taps = 1;
  for (float ratio2 = major2 / minor2; taps < 4 && ratio2 > 1.5F * static_cast<float>(taps * taps);) ++taps;
  constexpr float sharpness = -0.35F;  // trilinear filtering alone blurs more than a lens and sensor do
  const float level = 0.5F * quick_log2(major2) - (taps > 1 ? quick_log2(static_cast<float>(taps)) : 0.0F) + sharpness;
  std::uint64_t sum = 0;
  const auto centre_u = static_cast<float>(u), centre_v = static_cast<float>(v);
  for (int tap = 0; tap < taps; ++tap) {
    const float share = (static_cast<float>(tap) + 0.5F) / static_cast<float>(taps) - 0.5F;
    sum += triangle.texture->sample(centre_u + share * (lies ? du_dx : du_dy),
                                    centre_v + share * (lies ? dv_dx : dv_dy), level);
  }
  const float scale = light / static_cast<float>(taps);
  return {scale * static_cast<float>(sum & 0xffff), scale * static_cast<float>((sum >> 16) & 0xffff),
          scale * static_cast<float>(sum >> 32)};
}

std::uint8_t to_byte(float value) { return static_cast<std::uint8_t>(std::min(value + 0.5F, 255.0F)); }
}  // namespace

Renderer::Renderer(const World& world, const Camera& camera)
    : world_(world), camera_(camera), buffers_(std::make_unique<Buffers>(camera)) {
  HOLDFAST_CHECK(world.objects.size() < 65535, "objects " << world.objects.size());
}

Renderer::~Renderer() = default;

RenderedFrame Renderer::render(const Eigen::Isometry3d& T_world_camera, double time) {
  buffers_->visibility.draw(world_, T_world_camera, time);
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
  const RayGrid& grid = visibility.grid();
  const std::vector<VisibleTriangle>& triangles = visibility.triangles();
  const double pixel_x = 1.0 / camera_.fx, pixel_y = 1.0 / camera_.fy;
  constexpr std::uint32_t nothing = VisibilityBuffer::nothing;
  static constexpr int weights[9] = {1, 2, 1, 2, 4, 2, 1, 2, 1};

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
      if (number != nothing) {
        const VisibleTriangle& triangle = triangles[number];
        // The nearest sample is up to a quarter pixel off: on a surface seen almost edge-on the ray may miss it.
        const double sampled = visibility.inverse_depths(0)[ray->sample];
        const double exact =
            triangle.inverse_depth.x() * ray->x + triangle.inverse_depth.y() * ray->y + triangle.inverse_depth.z();
        const double inverse_depth = std::clamp(exact, 0.97 * sampled, 1.03 * sampled);
        depth[x] = static_cast<float>(1.0 / inverse_depth);
        object[x] = triangle.object;
        cosine[x] = static_cast<float>(inverse_depth) * triangle.inverse_norm * ray->inverse_length;
        sum = colour_of(triangle, ray->x, ray->y, inverse_depth, pixel_x, pixel_y);
      } else {
        depth[x] = 0.0F, object[x] = 0, cosine[x] = 0.0F;
      }

      const std::uint32_t* above = centre - grid.columns;
      const std::uint32_t* below = centre + grid.columns;
      const std::uint32_t around[9] = {above[-1], above[0],  above[1], centre[-1], number,
                                       centre[1], below[-1], below[0], below[1]};
      bool same = true;
      for (std::uint32_t other : around) same &= other == number;
      if (!same) {
        const auto surface_of = [&](std::uint32_t n) { return n == nothing ? nothing : triangles[n].surface; };
        std::uint32_t surfaces[9];
        for (int k = 0; k < 9; ++k) surfaces[k] = surface_of(around[k]);
        Colour blend;
        int done = 0;  // bit k: sample k has been counted
        for (int k = 0; k < 9; ++k) {
          const int first = (k + 4) % 9;  // the pixel's own surface comes first
          if (done & (1 << first)) continue;
          int weight = 0;
          for (int other = 0; other < 9; ++other)
            if (surfaces[other] == surfaces[first]) weight += weights[other], done |= 1 << other;
          if (surfaces[first] == nothing) continue;
          Colour part = sum;
          if (first != 4) {
            const std::int32_t sample = ray->sample + (first / 3 - 1) * grid.columns + first % 3 - 1;
            const double sample_x = grid.x0 + sample % grid.columns * grid.step_x;
            const double sample_y = grid.y0 + sample / grid.columns * grid.step_y;
            part = colour_of(triangles[around[first]], sample_x, sample_y, visibility.inverse_depths(0)[sample],
                             pixel_x, pixel_y);
          }
          const float share = static_cast<float>(weight) / 16.0F;
          blend.blue += share * part.blue, blend.green += share * part.green, blend.red += share * part.red;
        }
        sum = blend;
      }
      colour[0] = to_byte(sum.blue), colour[1] = to_byte(sum.green), colour[2] = to_byte(sum.red);
    }
  }
}

}  // namespace holdfast::simulation
