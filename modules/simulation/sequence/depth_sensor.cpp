// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "holdfast/simulation/sensor.hpp"
#include "row_random.hpp"

namespace holdfast::simulation {

namespace {
constexpr float projector_baseline = 0.075F;   // of a Kinect [m]
constexpr float kinect_focal_length = 580.0F;  // of its infrared camera [px]
constexpr float disparity_step = 0.125F;       // [px]

Floats4 all(float value) { return Floats4{value, value, value, value}; }

// The angular term of Nguyen et al. by cosine of incidence, without its 1 / sqrt(z).
std::array<float, 257> angular_noise() {
  std::array<float, 257> table{};
  for (int i = 0; i <= 256; ++i) {
    const double angle = std::min(std::acos(i / 256.0), 1.4);
    table[i] = static_cast<float>(0.0001 * std::pow(angle / (std::numbers::pi / 2 - angle), 2.0));
  }
  return table;
}

// Smooth noise from 0 to 1 over the image at a time: random numbers on a lattice of columns, rows and time, joined by
// smoothstep in space and time (Perlin 1985).
class RollingNoise {
 public:
  RollingNoise(cv::Size size, const Random& random, double time) {
    columns_ = size.width / cell + 2;
    const int rows = size.height / cell + 2;
    constexpr double interval = 0.25;  // [s]
    const double slice = std::floor(time / interval);
    const auto t = static_cast<float>(time / interval - slice);
    const float later = t * t * (3.0F - 2.0F * t);
    const auto number = static_cast<std::uint64_t>(static_cast<std::int64_t>(slice));
    Random before = random.fork(number), after = random.fork(number + 1);
    lattice_.resize(static_cast<std::size_t>(columns_) * rows);
    for (float& value : lattice_) {
      const auto from = static_cast<float>(before.uniform()), to = static_cast<float>(after.uniform());
      value = from + later * (to - from);
    }
  }

  float at(int x, int y) const {
    const float* corner = lattice_.data() + static_cast<std::size_t>(y / cell) * columns_ + x / cell;
    const float across = smooth(x), down = smooth(y);
    const float above = corner[0] + across * (corner[1] - corner[0]);
    const float below = corner[columns_] + across * (corner[columns_ + 1] - corner[columns_]);
    return above + down * (below - above);
  }

 private:
  static constexpr int cell = 8;  // [px]
  static float smooth(int position) {
    const float t = static_cast<float>(position % cell) / cell;
    return t * t * (3.0F - 2.0F * t);
  }

  int columns_ = 0;
  std::vector<float> lattice_;
};

// Marks the pixels of a row that the projector does not light: it stands to the right of the camera, so a point at
// column x with disparity d is column x - d to it, and what falls behind something nearer is hidden.
void mark_shadow(const float* depth, int width, float focal_length_baseline, float* columns, std::uint8_t* hole) {
  for (int x = 0; x < width; x += 4) {
    const auto first = static_cast<float>(x);
    const Floats4 column = Floats4{first, first + 1, first + 2, first + 3};
    store(columns + x, column - focal_length_baseline / larger(load<Floats4>(depth + x), all(1e-3F)));
  }
  float leftmost = std::numeric_limits<float>::infinity();
  for (int x = width - 1; x >= 0; --x) {
    if (depth[x] <= 0.0F) continue;
    if (columns[x] > leftmost + 0.5F) hole[x] = 1;
    leftmost = std::min(leftmost, columns[x]);
  }
}

// Marks a band along the depth edges.
void mark_edges(const cv::Mat& depth, const cv::Mat& cosine, double width, const RollingNoise& noise, Random frame,
                std::vector<std::uint8_t>& holes) {
  const int reach = static_cast<int>(std::ceil(width));
  const auto mark = [&](int x, int y) {
    const auto ragged = static_cast<float>(frame.uniform()) - 0.5F;
    const float radius = static_cast<float>(width) * noise.at(x, y) + ragged;
    if (radius <= 0.5F) return;
    for (int v = std::max(0, y - reach); v <= std::min(depth.rows - 1, y + reach); ++v)
      for (int u = std::max(0, x - reach); u <= std::min(depth.cols - 1, x + reach); ++u)
        if (static_cast<float>((u - x) * (u - x) + (v - y) * (v - y)) < (radius - 0.5F) * (radius - 0.5F) + 0.01F)
          holes[static_cast<std::size_t>(v) * depth.cols + u] = 1;
  };
  for (int y = 0; y < depth.rows; ++y) {
    const float* here = depth.ptr<float>(y);
    const float* below = depth.ptr<float>(std::min(y + 1, depth.rows - 1));
    const float* above = depth.ptr<float>(std::max(y - 1, 0));
    const float* facing = cosine.ptr<float>(y);
    const int last = depth.cols - 1;
    const auto is_edge = [&](int x) {
      const float z = here[x];
      if (z <= 0.0F) return false;
      // Surfaces seen flat change depth from pixel to pixel too: their own slope is no edge.
      const float step = z * std::max(0.02F, 0.004F / std::max(facing[x], 0.05F));
      return std::abs(below[x] - z) > step || std::abs(above[x] - z) > step ||
             std::abs(here[std::min(x + 1, last)] - z) > step || std::abs(here[std::max(x - 1, 0)] - z) > step;
    };
    int x = 1;
    if (is_edge(0)) mark(0, y);
    for (; x + 4 <= last; x += 4) {
      const auto z = load<Floats4>(here + x);
      const auto change = [&](const float* other) {
        const Floats4 difference = load<Floats4>(other) - z;
        return larger(difference, -difference);
      };
      const Floats4 largest =
          larger(larger(change(below + x), change(above + x)), larger(change(here + x + 1), change(here + x - 1)));
      const Integers4 far = largest > z * larger(all(0.02F), 0.004F / larger(load<Floats4>(facing + x), all(0.05F)));
      if ((far[0] | far[1] | far[2] | far[3]) == 0) continue;
      for (int k = 0; k < 4; ++k)
        if (far[k] != 0 && z[k] > 0.0F) mark(x + k, y);
    }
    for (; x <= last; ++x)
      if (is_edge(x)) mark(x, y);
  }
}
}  // namespace

cv::Mat sense_depth(const cv::Mat& depth, const cv::Mat& cosine, const Camera& camera,
                    const DepthSensorSettings& settings, std::uint64_t seed, double time) {
  static const std::array<float, 257> angular = angular_noise();
  constexpr float disparity_scale = kinect_focal_length * projector_baseline / disparity_step;
  const Floats4 nearest = all(static_cast<float>(settings.minimum_depth));
  const Floats4 farthest = all(static_cast<float>(settings.maximum_depth));
  const auto noise = static_cast<float>(settings.noise);
  const auto shadow_scale = static_cast<float>(camera.fx) * projector_baseline;
  const auto lost = static_cast<std::int32_t>(std::clamp(settings.dropout, 0.0, 1.0) * 65536.0);
  const Random sequence(seed);
  const Random frame = sequence.fork(std::bit_cast<std::uint64_t>(time));
  const int width = depth.cols, padded = (width + 3) / 4 * 4;
  std::vector<std::uint8_t> holes(depth.total(), 0);
  if (settings.edge_holes > 0.0)
    mark_edges(depth, cosine, settings.edge_holes, RollingNoise(depth.size(), sequence.fork(0xed6e), time),
               frame.fork(0xed6e), holes);
  std::vector<float> in(padded, 0.0F), facing(padded, 0.0F), out(padded), columns(padded);
  std::vector<std::uint8_t> hole(padded);
  cv::Mat sensed(depth.size(), CV_32FC1);
  for (int y = 0; y < depth.rows; ++y) {
    RowRandom random(frame.fork(static_cast<std::uint64_t>(y)));
    std::copy_n(depth.ptr<float>(y), width, in.data());
    std::copy_n(cosine.ptr<float>(y), width, facing.data());
    std::copy_n(holes.data() + static_cast<std::size_t>(y) * width, width, hole.data());
    if (settings.holes) mark_shadow(in.data(), width, shadow_scale, columns.data(), hole.data());

    for (int x = 0; x < width; x += 4) {
      const Words4 chance = random.next(), bits = random.next();
      Floats4 z = load<Floats4>(&in[x]);
      const Floats4 cosines = load<Floats4>(&facing[x]);
      Integers4 valid = (z > 0.0F) & (z >= nearest) & (z <= farthest);
      valid &= Integers4{hole[x], hole[x + 1], hole[x + 2], hole[x + 3]} == 0;
      if (lost > 0) valid &= reinterpret_cast<Integers4>(chance & 0xffffU) >= lost;
      if (settings.holes) {
        const Floats4 draw = __builtin_convertvector(reinterpret_cast<Integers4>(chance >> 16), Floats4) * 0x1.0p-16F;
        valid &= draw >= (0.21F - cosines) / 0.15F;
      }
      const Floats4 true_z = larger(z, all(0.01F));
      if (noise > 0.0F) {
        const Integers4 entry =
            __builtin_convertvector(smaller(larger(cosines, all(0.0F)), all(1.0F)) * 256.0F, Integers4);
        const Floats4 slanted = {angular[entry[0]], angular[entry[1]], angular[entry[2]], angular[entry[3]]};
        const Floats4 away = z - 0.4F;
        const Floats4 deviation = noise * (0.0012F + 0.0019F * away * away + slanted / square_root(true_z));
        const Floats4 step = z * z / disparity_scale;
        const Floats4 rounding2 = settings.quantisation ? step * step / 12.0F : all(0.0F);
        z += __builtin_convertvector(byte_sums(bits), Floats4) *
             (square_root(larger(deviation * deviation - rounding2, all(0.0F))) / byte_sum_deviation);
      }
      if (settings.quantisation) {
        const Integers4 steps = __builtin_convertvector(disparity_scale / larger(z, all(0.01F)) + 0.5F, Integers4);
        z = disparity_scale / __builtin_convertvector(steps, Floats4);
      }
      valid &= (z >= nearest) & (z <= farthest);
      store(&out[x], valid & reinterpret_cast<Integers4>(z));
    }
    std::copy_n(out.data(), width, sensed.ptr<float>(y));
  }
  return sensed;
}

}  // namespace holdfast::simulation
