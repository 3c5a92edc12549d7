// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/mesh_patches.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <tuple>
#include <unordered_map>

namespace holdfast {

std::vector<SurfacePatch> patches_of(const TriangleMesh& mesh) {
  constexpr std::size_t most_triangles = 10'000;  // whose corners 16 bits can name
  const auto cube_of = [&](std::size_t triangle) -> Eigen::Vector3i {
    return mesh.corner(triangle, 0).array().floor().max(-1e9F).min(1e9F).cast<int>();
  };
  std::vector<std::tuple<int, int, int, std::size_t>> order;
  order.reserve(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Eigen::Vector3i cube = cube_of(i);
    order.emplace_back(cube.x(), cube.y(), cube.z(), i);
  }
  std::sort(order.begin(), order.end());

  std::vector<SurfacePatch> patches;
  std::unordered_map<std::uint32_t, std::uint16_t> numbers;  // of the vertices in the last patch; never iterated over
  for (const auto& [x, y, z, triangle] : order) {
    const Eigen::Vector3i cube(x, y, z);
    if (patches.empty() || patches.back().cube != cube || patches.back().triangles.size() == most_triangles) {
      patches.push_back({cube, {}, {}});
      numbers.clear();
    }
    SurfacePatch& patch = patches.back();
    std::array<std::uint16_t, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = mesh.triangles[triangle][k];
      const auto [place, is_new] = numbers.try_emplace(vertex, static_cast<std::uint16_t>(patch.vertices.size()));
      if (is_new) patch.vertices.push_back(mesh.vertices[vertex]);
      corners[k] = place->second;
    }
    patch.triangles.push_back(corners);
  }
  return patches;
}

}  // namespace holdfast
