// SPDX-License-Identifier: BSD-3-Clause
#include "integrator.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <utility>

#include "holdfast/core/simd.hpp"
#include "lanes.hpp"

namespace holdfast::surface {

namespace {

constexpr float growth = 1.5F;  // of the weight of a view in the balance, from view to view
constexpr std::uint32_t largest_number = 65535;
constexpr float nearest_depth = 0.1F;     // [m]
constexpr std::int32_t most_faded = 128;  // views, after which nothing is left of one

/// growth^-views
constexpr auto faded = [] {
  std::array<float, most_faded + 1> values{};
  float value = 1.0F;
  for (int i = 0; i < most_faded; ++i, value /= growth) values[static_cast<std::size_t>(i)] = value;
  return values;
}();

void add_colour(Block& block, std::size_t i, const ViewImage::Pixel& pixel, int sign) {
  if (!block.colour) block.colour = std::make_unique<std::array<Block::Colour, Block::size>>();
  Block::Colour& colour = (*block.colour)[i];
  if (sign > 0 && colour.count == Block::colour_limit)
    colour.red /= 2, colour.green /= 2, colour.blue /= 2, colour.count /= 2;
  const auto add = [&](std::uint16_t& sum, int value) {
    sum = static_cast<std::uint16_t>(std::max(sum + sign * value, 0));
  };
  add(colour.red, pixel.red);
  add(colour.green, pixel.green);
  add(colour.blue, pixel.blue);
  add(colour.count, 1);
}

void add_vote(Block& block, std::size_t i, std::uint8_t label, int sign) {
  if (label == Block::Votes::unknown) return;
  if (!block.votes) block.votes = std::make_unique<std::array<Block::Votes, Block::size>>();
  (*block.votes)[i].add(label, sign);
}

using Short8 = std::uint16_t __attribute__((vector_size(16)));
using Byte8 = std::uint8_t __attribute__((vector_size(8)));

struct Pixels8 {
  Float8 depth, near, slope;
  Int8 weight;
};

/// The pixels at eight places, each read as a whole.
HOLDFAST_INLINE Pixels8 load_pixels(const ViewImage::Pixel* pixels, const Int8& place) {
  static_assert(sizeof(ViewImage::Pixel) == 16 && offsetof(ViewImage::Pixel, near) == 4 &&
                offsetof(ViewImage::Pixel, slope) == 8 && offsetof(ViewImage::Pixel, weight) == 12);
  using Float4 = float __attribute__((vector_size(16)));
  Float8 pair[4];  // the pixels k and k + 4
  for (int k = 0; k < 4; ++k) {
    Float4 low, high;
    std::memcpy(&low, pixels + place[k], sizeof(low));
    std::memcpy(&high, pixels + place[k + 4], sizeof(high));
    pair[k] = __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
  }
  // The transposed 4x4 of each half.
  const Float8 a = __builtin_shufflevector(pair[0], pair[1], 0, 8, 1, 9, 4, 12, 5, 13);
  const Float8 b = __builtin_shufflevector(pair[0], pair[1], 2, 10, 3, 11, 6, 14, 7, 15);
  const Float8 c = __builtin_shufflevector(pair[2], pair[3], 0, 8, 1, 9, 4, 12, 5, 13);
  const Float8 d = __builtin_shufflevector(pair[2], pair[3], 2, 10, 3, 11, 6, 14, 7, 15);
  const Float8 last = __builtin_shufflevector(b, d, 2, 3, 10, 11, 6, 7, 14, 15);
  Int8 bits;
  std::memcpy(&bits, &last, sizeof(bits));
  return {__builtin_shufflevector(a, c, 0, 1, 8, 9, 4, 5, 12, 13),
          __builtin_shufflevector(a, c, 2, 3, 10, 11, 6, 7, 14, 15),
          __builtin_shufflevector(b, d, 0, 1, 8, 9, 4, 5, 12, 13), bits & 255};
}

/// Adds `amount` to the balance of eight voxels from `first` on, where `is_active`.
HOLDFAST_INLINE void add_balance(const ViewGeometry& view, Block& block, std::size_t first, const Int8& is_active,
                                 const Float8& amount) {
  Float8 balance;
  Short8 last_bits;
  std::memcpy(&balance, &block.balance[first], sizeof(balance));
  std::memcpy(&last_bits, &block.last[first], sizeof(last_bits));
  const Int8 last = __builtin_convertvector(last_bits, Int8);
  const Int8 is_later = view.number > last;
  Int8 views = is_later ? view.number - last : last - view.number;
  views = views > most_faded ? Int8{} + most_faded : views;
  Float8 factor = Float8{} + faded[static_cast<std::size_t>(views[0])];
  if (any_of(views != views[0]))
    for (int k = 1; k < 8; ++k) factor[k] = faded[static_cast<std::size_t>(views[k])];
  const Float8 sum =
      (is_later ? balance * factor : balance) + static_cast<float>(view.sign) * (is_later ? amount : amount * factor);
  balance = is_active ? sum : balance;
  last_bits = __builtin_convertvector((is_active & is_later) ? Int8{} + view.number : last, Short8);
  std::memcpy(&block.balance[first], &balance, sizeof(balance));
  std::memcpy(&block.last[first], &last_bits, sizeof(last_bits));
}

/// Counts a view in eight counters, where `is_active`.
HOLDFAST_INLINE void count_view(const ViewGeometry& view, std::uint8_t* counters, const Int8& is_active) {
  Byte8 bits;
  std::memcpy(&bits, counters, sizeof(bits));
  Int8 counts = __builtin_convertvector(bits, Int8);
  counts += is_active & (counts < 255) & (Int8{} + view.sign);
  bits = __builtin_convertvector(counts < 0 ? Int8{} : counts, Byte8);
  std::memcpy(counters, &bits, sizeof(bits));
}

/// Adds a view to the eight voxels from `first` on. `x`, `y`, `z`: the first one in the frame of the camera. `far`: no
/// depth in the block's part of a view that only carves is larger.
template <bool only_carves>
HOLDFAST_INLINE void update_row(const ViewGeometry& view, float x, float y, float z, float far, Block& block,
                                std::size_t first) {
  if (only_carves && far - std::min(z, z + 7.0F * view.rotation[8]) <= view.truncation) return;  // the margin or less
  const Float8 steps = {0.0F, 1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 6.0F, 7.0F};
  const Float8 depth = z + steps * view.rotation[8];
  const Float8 inverse = 1.0F / depth;
  Float8 u = view.fx * (x + steps * view.rotation[6]) * inverse + view.cx;
  Float8 v = view.fy * (y + steps * view.rotation[7]) * inverse + view.cy;
  const Int8 is_inside = (depth >= nearest_depth) & (u >= 0.0F) & (v >= 0.0F) & (u < view.width) & (v < view.height);
  if (!any_of(is_inside)) return;
  u = is_inside ? u : Float8{};
  v = is_inside ? v : Float8{};
  const Int8 place =
      __builtin_convertvector(v, Int8) * static_cast<std::int32_t>(view.width) + __builtin_convertvector(u, Int8);
  const Float8 square_margin = ViewGeometry::constant_margin + ViewGeometry::quadratic_margin * depth * depth;
  const Float8 margin = square_margin < view.truncation ? Float8{} + view.truncation : square_margin;
  if constexpr (only_carves) {
    Float8 near;
    for (int k = 0; k < 8; ++k) near[k] = view.near[place[k]];
    const Int8 is_free = is_inside & (near - depth > margin);
    if (any_of(is_free)) add_balance(view, block, first, is_free, Float8{} - 1.0F);
  } else {
    const Pixels8 pixels = load_pixels(view.pixels, place);
    const Float8 &surface = pixels.depth, &near = pixels.near, &slope = pixels.slope;
    const Int8& weight = pixels.weight;
    const Int8 is_free = is_inside & ((near - depth) * slope > margin);
    const Float8 distance = (surface - depth) * slope;
    const Float8 length = distance < 0.0F ? -distance : distance;
    const Int8 is_near = is_inside & ~is_free & (weight != 0) & (length <= view.truncation);
    const Int8 counts = is_free | (is_near & (distance < 0.5F * view.truncation));
    if (any_of(counts)) add_balance(view, block, first, counts, is_free ? Float8{} - 1.0F : Float8{} + 1.0F);
    const Float8 behind = (surface + depth) * slope;
    const Int8 is_dynamic = is_inside & (surface < 0.0F) & ((behind < 0.0F ? -behind : behind) <= view.truncation);
    if (any_of(is_dynamic)) count_view(view, &block.moving[first], is_dynamic);
    if (!any_of(is_near)) return;

    Int8 sum;
    Short8 weight_bits;
    std::memcpy(&sum, &block.distance[first], sizeof(sum));
    std::memcpy(&weight_bits, &block.weight[first], sizeof(weight_bits));
    const Float8 scaled = distance / view.truncation * static_cast<float>(Block::truncation_units);
    const Float8 rounded = scaled + (scaled < 0.0F ? Float8{} - 0.5F : Float8{} + 0.5F);
    const Int8 units = __builtin_convertvector(is_near ? rounded : Float8{}, Int8);
    sum += is_near & (view.sign * units * weight);
    // Halves the sums before they overflow, after more than a thousand views.
    Int8 weights = __builtin_convertvector(weight_bits, Int8);
    const Int8 is_full = is_near & (weights > 65535 - 64);
    weights = is_full ? weights >> 1 : weights;
    sum = is_full ? (sum - (sum < 0)) >> 1 : sum;
    weights += is_near & (view.sign * weight);
    weights = weights < 0 ? Int8{} : weights;
    weight_bits = __builtin_convertvector(weights, Short8);
    std::memcpy(&block.distance[first], &sum, sizeof(sum));
    std::memcpy(&block.weight[first], &weight_bits, sizeof(weight_bits));
    count_view(view, &block.views[first], is_near);
    const Int8 has_colour = is_near & (length < 1.5F * view.voxel);
    for (int k = 0; k < 8; ++k)
      if (has_colour[k] != 0) {
        add_colour(block, first + static_cast<std::size_t>(k), view.pixels[place[k]], view.sign);
        if (view.labels != nullptr)
          add_vote(block, first + static_cast<std::size_t>(k), view.labels[place[k]], view.sign);
      }
  }
}

template <bool only_carves>
HOLDFAST_INLINE void update_voxels(const ViewGeometry& view, const float* corner, float far, Block& block) {
  const float* const r = view.rotation;
  for (int i = 0; i < Block::side * Block::side; ++i) {
    const auto a = static_cast<float>(i / Block::side), b = static_cast<float>(i % Block::side);
    update_row<only_carves>(view, corner[0] + a * r[0] + b * r[3], corner[1] + a * r[1] + b * r[4],
                            corner[2] + a * r[2] + b * r[5], far, block, static_cast<std::size_t>(i * Block::side));
  }
}

HOLDFAST_INLINE void carve_all(const ViewGeometry& view, Block& block) {
  for (std::size_t i = 0; i < Block::size; i += Block::side) add_balance(view, block, i, Int8{} - 1, Float8{} - 1.0F);
}

// The same loops once per set of instructions.
#define HOLDFAST_LOOPS(name, target)                                                               \
  struct name {                                                                                    \
    target static void fuse(const ViewGeometry& view, const float* corner, float far, Block& b) {  \
      update_voxels<false>(view, corner, far, b);                                                  \
    }                                                                                              \
    target static void carve(const ViewGeometry& view, const float* corner, float far, Block& b) { \
      update_voxels<true>(view, corner, far, b);                                                   \
    }                                                                                              \
    target static void carve_all(const ViewGeometry& view, const float*, float, Block& b) {        \
      surface::carve_all(view, b);                                                                 \
    }                                                                                              \
  };

HOLDFAST_LOOPS(ScalarLoops, )
#if defined(__x86_64__)
HOLDFAST_LOOPS(Sse4Loops, __attribute__((target("sse4.1"))))
HOLDFAST_LOOPS(Avx2Loops, __attribute__((target("avx2"))))
#endif

#undef HOLDFAST_LOOPS

}  // namespace

Integrator::Integrator(const ViewImage& image, const Eigen::Isometry3d& T_world_camera, std::uint32_t number, int sign,
                       const SurfaceSettings& settings)
    : image_(image) {
  const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
  rotation_ = T_camera_world.linear().cast<float>();
  translation_ = T_camera_world.translation().cast<float>();
  const Camera& camera = image.camera();
  view_.voxel = static_cast<float>(settings.voxel);
  const float half = 0.5F * view_.voxel * Block::side;
  centre_ = rotation_ * Eigen::Vector3f::Constant(half);
  half_ = rotation_.cwiseAbs() * Eigen::Vector3f::Constant(half);
  view_.truncation = static_cast<float>(settings.truncation * settings.voxel);
  Eigen::Map<Eigen::Matrix3f>(view_.rotation) = rotation_ * view_.voxel;
  view_.fx = static_cast<float>(camera.fx), view_.fy = static_cast<float>(camera.fy);
  view_.cx = static_cast<float>(camera.cx + 0.5), view_.cy = static_cast<float>(camera.cy + 0.5);
  view_.width = static_cast<float>(camera.width), view_.height = static_cast<float>(camera.height);
  view_.pixels = image.pixels();
  view_.near = image.near();
  view_.labels = image.labels();
  view_.number = static_cast<std::int32_t>(std::min(number, largest_number));
  view_.sign = sign;
  const auto take = [&](auto loops) {
    using Loops = decltype(loops);
    update_voxels_ = image_.only_carves() ? Loops::carve : Loops::fuse;
    carve_all_ = Loops::carve_all;
  };
  take(ScalarLoops());
#if defined(__x86_64__)
  if (simd_level() >= SimdLevel::sse4) take(Sse4Loops());
  if (simd_level() >= SimdLevel::avx2) take(Avx2Loops());
#endif
}

void Integrator::update(const Blocks& blocks, std::uint64_t births) const {
  const std::vector<Eigen::Vector3i>& coordinates = blocks.coordinates();
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    const Eigen::Vector3f corner =
        rotation_ * (coordinates[i].cast<float>() * (view_.voxel * Block::side)) + translation_;
    const auto [reach, far] = reach_of(corner);
    if (reach == Reach::nothing) continue;
    Block& block = *blocks.list()[i];
    if (block.birth >= births) return;  // and so are all that follow
    block.version = blocks.version();
    (reach == Reach::all_free ? carve_all_ : update_voxels_)(view_, corner.data(), far, block);
  }
}

float Integrator::margin_at(float depth) const {
  return std::max(view_.truncation, ViewGeometry::constant_margin + ViewGeometry::quadratic_margin * depth * depth);
}

std::pair<Integrator::Reach, float> Integrator::reach_of(const Eigen::Vector3f& corner) const {
  constexpr float rounding = 0.01F;  // [px]
  const Eigen::Vector3f centre = corner + centre_;
  const float nearest = centre.z() - half_.z(), last = centre.z() + half_.z();
  if (last < nearest_depth) return {Reach::nothing, 0.0F};
  // Close to the camera the projection of the box may be unbounded.
  constexpr float infinite = std::numeric_limits<float>::infinity();
  if (nearest < nearest_depth) return {Reach::something, infinite};
  const float of_nearest = 1.0F / nearest, of_last = 1.0F / last;
  const auto lower = [&](float side, float focal_length, float principal_point) {
    return focal_length * side * (side < 0.0F ? of_nearest : of_last) + principal_point - rounding;
  };
  const auto upper = [&](float side, float focal_length, float principal_point) {
    return focal_length * side * (side < 0.0F ? of_last : of_nearest) + principal_point + rounding;
  };
  const float left = lower(centre.x() - half_.x(), view_.fx, view_.cx);
  const float top = lower(centre.y() - half_.y(), view_.fy, view_.cy);
  const float right = upper(centre.x() + half_.x(), view_.fx, view_.cx);
  const float bottom = upper(centre.y() + half_.y(), view_.fy, view_.cy);
  if (right < 0.0F || bottom < 0.0F || left > view_.width || top > view_.height) return {Reach::nothing, 0.0F};
  const int right_pixel = static_cast<int>(right), bottom_pixel = static_cast<int>(bottom);
  const int left_pixel = static_cast<int>(std::floor(left)), top_pixel = static_cast<int>(std::floor(top));
  if (image_.only_carves()) {
    const auto [near, far] = image_.near_range(left_pixel, top_pixel, right_pixel, bottom_pixel);
    if (far - nearest <= margin_at(nearest)) return {Reach::nothing, 0.0F};
    return {near - last > margin_at(last) ? Reach::all_free : Reach::something, far};
  }
  const float farthest = image_.farthest(left_pixel, top_pixel, right_pixel, bottom_pixel);
  const bool is_behind = nearest >= farthest + view_.truncation / ViewImage::smallest_slope;
  return {farthest <= 0.0F || is_behind ? Reach::nothing : Reach::something, infinite};
}

}  // namespace holdfast::surface
