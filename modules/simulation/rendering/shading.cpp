// SPDX-License-Identifier: BSD-3-Clause
#include "shading.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "vectors.hpp"

namespace holdfast::simulation {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {
constexpr double samples_per_pixel = 2.0;
constexpr std::uint32_t nothing = VisibilityBuffer::nothing;

// Base-2 logarithm with an error below 0.01: enough to choose a mip level.
float quick_log2(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const auto mantissa = std::bit_cast<float>((bits & 0x7fffffU) | 0x3f800000U);
  return static_cast<float>(static_cast<int>(bits >> 23) - 127) + (-0.34484843F * mantissa + 2.02466578F) * mantissa -
         1.67487759F;
}

// What a pixel sees of a triangle's texture at (u, v). Footprints that are longer than wide take up to four samples
// along their length, so that desks and floors seen flat stay sharp.
Texture::Footprint footprint_of(const VisibleTriangle& triangle, float u, float v, float depth, float pixel_x,
                                float pixel_y) {
  const auto slope_x = static_cast<float>(triangle.inverse_depth.x());
  const auto slope_y = static_cast<float>(triangle.inverse_depth.y());
  const float scale_x = depth * pixel_x, scale_y = depth * pixel_y;
  const float du_dx = (triangle.u.x() - u * slope_x) * scale_x, dv_dx = (triangle.v.x() - v * slope_x) * scale_x;
  const float du_dy = (triangle.u.y() - u * slope_y) * scale_y, dv_dy = (triangle.v.y() - v * slope_y) * scale_y;
  const float across2 = du_dx * du_dx + dv_dx * dv_dx, down2 = du_dy * du_dy + dv_dy * dv_dy;
  const bool lies = across2 > down2;
  const float major2 = std::max({across2, down2, 1e-12F}), minor2 = std::max(std::min(across2, down2), 1e-12F);

  static constexpr float logarithms[5] = {0.0F, 0.0F, 1.0F, 1.5849625F, 2.0F};
  const int taps = 1 + (major2 > 2.25F * minor2) + (major2 > 9.0F * minor2) + (major2 > 20.25F * minor2);
  constexpr float blur = 0.4F;  // of a lens, on top of that of trilinear filtering [mip levels]
  return {lies ? du_dx : du_dy, lies ? dv_dx : dv_dy, taps, 0.5F * quick_log2(major2) - logarithms[taps] + blur};
}

// Colours of a triangle where up to four rays (x, y, 1) meet it; neighbours, so that their footprint is one.
inline void shade_four(const VisibleTriangle& triangle, const FloorShade& floor, Floats4 x, Floats4 y, Floats4 depth,
                       int count, float pixel_x, float pixel_y, float* colours) {
  const auto at = [&](const Vector3f& gradient) {
    return (gradient.x() * x + gradient.y() * y + gradient.z()) * depth;
  };
  alignas(16) float u[4], v[4];
  store(u, at(triangle.u));
  store(v, at(triangle.v));
  Floats4 light = at(triangle.light);
  if (triangle.floor && !floor.shadows.empty()) {
    const auto world = [&](int row) {
      const auto& from = floor.xy_of_ray;
      return (from(row, 0) * x + from(row, 1) * y + from(row, 2)) * depth + from(row, 3);
    };
    light *= unshaded(floor.shadows, world(0), world(1));
  }
  const int middle = count >> 1;
  triangle.texture->sample(u, v, count, footprint_of(triangle, u[middle], v[middle], depth[middle], pixel_x, pixel_y),
                           colours);
  for (int k = 0; k < count; ++k) store(colours + 4 * k, load<Floats4>(colours + 4 * k) * light[k]);
}

inline void to_bytes(Floats4 colour, std::uint8_t* bytes) {
  const Floats4 most = {255.0F, 255.0F, 255.0F, 255.0F};
  const Integers4 rounded = __builtin_convertvector(smaller(colour + 0.5F, most), Integers4);
  for (int channel = 0; channel < 3; ++channel) bytes[channel] = static_cast<std::uint8_t>(rounded[channel]);
}
}  // namespace

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

Shader::Shader(const Camera& camera, const RayGrid& grid) : camera_(camera), stride_(camera.width + 4) {
  const std::size_t count = static_cast<std::size_t>(stride_) * camera.height;
  ray_x_.resize(count), ray_y_.resize(count), inverse_length_.resize(count);
  sample_.resize(count);
  numbers_.resize(stride_), depth_.resize(stride_), cosine_.resize(stride_), colours_.resize(4 * stride_);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < stride_; ++x) {
      const Vector2d pixel = camera.undistort({std::min(x, camera.width - 1), y});
      const Vector3d ray = camera.back_project(pixel.x(), pixel.y(), 1.0);
      const auto column = std::clamp<long>(std::lround((ray.x() - grid.x0) / grid.step_x), 1, grid.columns - 3);
      const auto row = std::clamp<long>(std::lround((ray.y() - grid.y0) / grid.step_y), 1, grid.rows - 2);
      const std::size_t i = static_cast<std::size_t>(y) * stride_ + x;
      ray_x_[i] = static_cast<float>(ray.x()), ray_y_[i] = static_cast<float>(ray.y());
      inverse_length_[i] = static_cast<float>(1.0 / ray.norm());
      sample_[i] = static_cast<std::int32_t>(row * grid.columns + column);
    }
}

void Shader::take_shadows(const std::vector<ContactShadow>& shadows, const Eigen::Isometry3d& T_world_camera) {
  floor_.shadows = shadows;
  floor_.xy_of_ray = T_world_camera.matrix().topRows<2>().cast<float>();
}

void Shader::shade(const VisibilityBuffer& visibility, const std::vector<ContactShadow>& shadows,
                   const Eigen::Isometry3d& T_world_camera, RenderedFrame& frame) {
  take_shadows(shadows, T_world_camera);
  frame.colour.create(camera_.height, camera_.width, CV_8UC3);
  frame.depth.create(camera_.height, camera_.width, CV_32FC1);
  frame.object_ids.create(camera_.height, camera_.width, CV_16UC1);
  frame.cosine.create(camera_.height, camera_.width, CV_32FC1);
  const std::vector<VisibleTriangle>& triangles = visibility.triangles();
  for (int y = 0; y < camera_.height; ++y) {
    shade_row(visibility, y);
    smooth_edges(visibility, y, frame.colour.ptr<std::uint8_t>(y));
    std::copy_n(depth_.data(), camera_.width, frame.depth.ptr<float>(y));
    std::copy_n(cosine_.data(), camera_.width, frame.cosine.ptr<float>(y));
    auto* object = frame.object_ids.ptr<std::uint16_t>(y);
    for (int x = 0; x < camera_.width; ++x) object[x] = numbers_[x] == nothing ? 0 : triangles[numbers_[x]].object;
  }
}

void Shader::shade_colour(const VisibilityBuffer& visibility, const std::vector<ContactShadow>& shadows,
                          const Eigen::Isometry3d& T_world_camera, cv::Mat& colour) {
  take_shadows(shadows, T_world_camera);
  colour.create(camera_.height, camera_.width, CV_8UC3);
  for (int y = 0; y < camera_.height; ++y) {
    shade_row(visibility, y);
    smooth_edges(visibility, y, colour.ptr<std::uint8_t>(y));
  }
}

// Runs of pixels on one triangle are shaded by fours; what is computed beyond the end of a run is written over by the
// next.
void Shader::shade_row(const VisibilityBuffer& visibility, int y) {
  const std::vector<VisibleTriangle>& triangles = visibility.triangles();
  const auto pixel_x = static_cast<float>(1.0 / camera_.fx), pixel_y = static_cast<float>(1.0 / camera_.fy);
  const std::size_t row = static_cast<std::size_t>(y) * stride_;
  const std::int32_t* samples = sample_.data() + row;
  const std::uint32_t* cells = visibility.row(0);
  const float* inverse_depths = visibility.inverse_depths(0);
  for (int x = 0; x < camera_.width; ++x) numbers_[x] = cells[samples[x]];

  for (int x = 0; x < camera_.width;) {
    const std::uint32_t number = numbers_[x];
    int count = 1;
    while (count < 4 && x + count < camera_.width && numbers_[x + count] == number) ++count;
    const Floats4 zero = {0, 0, 0, 0};
    if (number == nothing) {
      for (int k = 0; k < count; ++k) store(&colours_[4 * (x + k)], zero);
      store(&depth_[x], zero);
      store(&cosine_[x], zero);
      x += count;
      continue;
    }
    const VisibleTriangle& triangle = triangles[number];
    const auto ray_x = load<Floats4>(&ray_x_[row + x]), ray_y = load<Floats4>(&ray_y_[row + x]);
    Floats4 inverse_depth;
    for (int k = 0; k < 4; ++k)
      inverse_depth[k] = static_cast<float>(triangle.inverse_depth.x() * ray_x[k] +
                                            triangle.inverse_depth.y() * ray_y[k] + triangle.inverse_depth.z());
    // The nearest sample is up to a quarter pixel off: on a surface seen almost edge-on the ray may miss it.
    const Floats4 sampled = {inverse_depths[samples[x]], inverse_depths[samples[x + 1]], inverse_depths[samples[x + 2]],
                             inverse_depths[samples[x + 3]]};
    inverse_depth = larger(smaller(inverse_depth, 1.03F * sampled), 0.97F * sampled);
    const Floats4 depth = 1.0F / inverse_depth;
    store(&depth_[x], depth);
    store(&cosine_[x], inverse_depth * triangle.inverse_norm * load<Floats4>(&inverse_length_[row + x]));
    shade_four(triangle, floor_, ray_x, ray_y, depth, count, pixel_x, pixel_y, &colours_[4 * x]);
    x += count;
  }
}

// A pixel's colour is the mean of the nine samples around it, weighted as a tent. Samples on the pixel's own surface
// have its colour: a smooth surface is shaded once.
void Shader::smooth_edges(const VisibilityBuffer& visibility, int y, std::uint8_t* colour) const {
  const std::int32_t* samples = sample_.data() + static_cast<std::size_t>(y) * stride_;
  const int columns = visibility.grid().columns;
  const std::vector<std::uint32_t>& surface_of = visibility.surfaces();
  for (int x = 0; x < camera_.width; ++x, colour += 3) {
    const std::uint32_t* centre = visibility.row(0) + samples[x];
    const std::uint32_t *above = centre - columns, *below = centre + columns;
    const auto number = static_cast<std::int32_t>(*centre);
    const Integers4 own = {number, number, number, number};
    const Integers4 difference =
        (load<Integers4>(above - 1) ^ own) | (load<Integers4>(centre - 1) ^ own) | (load<Integers4>(below - 1) ^ own);
    if ((difference[0] | difference[1] | difference[2]) != 0) {
      const std::uint32_t around[9] = {above[-1], above[0],  above[1], centre[-1], centre[0],
                                       centre[1], below[-1], below[0], below[1]};
      const auto surface = [&](std::uint32_t triangle) { return triangle == nothing ? nothing : surface_of[triangle]; };
      const std::uint32_t own_surface = surface(around[4]);
      bool edge = false;
      for (const std::uint32_t triangle : around) edge = edge || surface(triangle) != own_surface;
      if (edge) {
        alignas(16) float blend[4];
        store(blend, load<Floats4>(&colours_[4 * x]));
        blend_edge(visibility, samples[x], around, blend);
        to_bytes(load<Floats4>(blend), colour);
        continue;
      }
    }
    to_bytes(load<Floats4>(&colours_[4 * x]), colour);
  }
}

void Shader::blend_edge(const VisibilityBuffer& visibility, std::int32_t sample, const std::uint32_t* around,
                        float* colour) const {
  static constexpr int weights[9] = {1, 2, 1, 2, 4, 2, 1, 2, 1};
  const auto pixel_x = static_cast<float>(1.0 / camera_.fx), pixel_y = static_cast<float>(1.0 / camera_.fy);
  const RayGrid& grid = visibility.grid();
  std::uint32_t surfaces[9];
  for (int k = 0; k < 9; ++k) surfaces[k] = around[k] == nothing ? nothing : visibility.surfaces()[around[k]];
  const auto own = load<Floats4>(colour);
  Floats4 blend = {0, 0, 0, 0};
  int counted = 0;  // bit k: sample k
  for (int k = 0; k < 9; ++k) {
    if (counted & (1 << k)) continue;
    int weight = 0;
    for (int other = k; other < 9; ++other)
      if (surfaces[other] == surfaces[k]) weight += weights[other], counted |= 1 << other;
    if (surfaces[k] == nothing) continue;
    Floats4 part = own;
    if (surfaces[k] != surfaces[4]) {
      const std::int32_t there = sample + (k / 3 - 1) * grid.columns + k % 3 - 1;
      const Floats4 zero = {0, 0, 0, 0};
      const Floats4 x = zero + static_cast<float>(grid.x0 + there % grid.columns * grid.step_x);
      const Floats4 y = zero + static_cast<float>(grid.y0 + there / grid.columns * grid.step_y);
      alignas(16) float colours[4];
      shade_four(visibility.triangles()[around[k]], floor_, x, y, 1.0F / (zero + visibility.inverse_depths(0)[there]),
                 1, pixel_x, pixel_y, colours);
      part = load<Floats4>(colours);
    }
    blend += part * (static_cast<float>(weight) / 16.0F);
  }
  store(colour, blend);
}

}  // namespace holdfast::simulation
