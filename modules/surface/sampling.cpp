// SPDX-License-Identifier: BSD-3-Clause
#include "sampling.hpp"

#include <array>
#include <cmath>

namespace holdfast::surface {

std::optional<SurfaceField::Sample> sample(const Blocks& blocks, const SurfaceSettings& settings,
                                           const Eigen::Vector3f& point) {
  const Eigen::Vector3f lowest = point.array().floor();
  const Eigen::Vector3i corner = lowest.cast<int>();
  const Eigen::Vector3f t = point - lowest;
  std::array<float, 8> values{};  // by 4 x + 2 y + z
  Eigen::Vector3i last = Eigen::Vector3i::Zero();
  const Block* block = nullptr;
  for (int k = 0; k < 8; ++k) {
    const Eigen::Vector3i voxel = corner + Eigen::Vector3i(k >> 2, (k >> 1) & 1, k & 1);
    const Eigen::Vector3i coordinates(voxel.x() >> 3, voxel.y() >> 3, voxel.z() >> 3);
    if (block == nullptr || coordinates != last) {
      const std::int32_t found = blocks.find(coordinates);
      if (found < 0) return std::nullopt;
      block = blocks.list()[static_cast<std::size_t>(found)].get();
      last = coordinates;
    }
    const auto at = static_cast<std::size_t>(Block::index(voxel.x() & 7, voxel.y() & 7, voxel.z() & 7));
    if (!block->is_observed(at, settings.minimum_views) || block->balance[at] < Block::free_below) return std::nullopt;
    values[static_cast<std::size_t>(k)] = block->mean(at);
  }
  const auto between = [](float a, float b, float share) { return a + share * (b - a); };
  const auto& v = values;
  const std::array<float, 4> along_x = {between(v[0], v[4], t.x()), between(v[1], v[5], t.x()),
                                        between(v[2], v[6], t.x()), between(v[3], v[7], t.x())};
  const float low = between(along_x[0], along_x[2], t.y()), high = between(along_x[1], along_x[3], t.y());
  const Eigen::Vector3f slope(
      between(between(v[4] - v[0], v[6] - v[2], t.y()), between(v[5] - v[1], v[7] - v[3], t.y()), t.z()),
      between(along_x[2] - along_x[0], along_x[3] - along_x[1], t.z()), high - low);
  const auto truncation = static_cast<float>(settings.truncation);  // [voxels]
  const auto side = static_cast<float>(settings.voxel);
  return SurfaceField::Sample{between(low, high, t.z()) * truncation * side, slope * truncation};
}

}  // namespace holdfast::surface
