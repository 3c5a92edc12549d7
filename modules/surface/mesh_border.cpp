// SPDX-License-Identifier: BSD-3-Clause
#include "mesh_border.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace holdfast::surface {

namespace {

/// The first vertex at the position of each vertex.
std::vector<std::uint32_t> first_at_position(const TriangleMesh& mesh) {
  std::map<std::array<float, 3>, std::uint32_t> found;
  std::vector<std::uint32_t> first;
  for (std::uint32_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3f& p = mesh.vertices[i].position;
    first.push_back(found.try_emplace({p.x(), p.y(), p.z()}, i).first->second);
  }
  return first;
}

}  // namespace

MeshBorder::MeshBorder(const TriangleMesh& mesh) : mesh_(mesh) {
  const std::vector<std::uint32_t> first = first_at_position(mesh);
  const auto ends = [&](std::size_t triangle, std::size_t k) {
    const std::uint32_t a = first[mesh.triangles[triangle][k]], b = first[mesh.triangles[triangle][(k + 1) % 3]];
    return std::pair(std::min(a, b), std::max(a, b));
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> triangles_at;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) ++triangles_at[ends(i, k)];
  std::vector<bool> is_on_border(mesh.vertices.size(), false);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    edge_.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = ends(i, k);
      if (!(edge_[i][k] = a != b && triangles_at[{a, b}] == 1)) continue;  // corners in one place make no edge
      is_on_border[a] = is_on_border[b] = true;
    }
  }
  for (const auto& triangle : mesh.triangles)
    corner_.push_back(
        {is_on_border[first[triangle[0]]], is_on_border[first[triangle[1]]], is_on_border[first[triangle[2]]]});
}

bool MeshBorder::contains(std::size_t triangle, const Eigen::Vector3d& point) const {
  constexpr double rounding = 1e-6;  // [m]
  for (int k = 0; k < 3; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const Eigen::Vector3d a = mesh_.corner(triangle, k).cast<double>();
    if (corner_[triangle][at] && (point - a).norm() < rounding) return true;
    if (!edge_[triangle][at]) continue;
    const Eigen::Vector3d edge = mesh_.corner(triangle, (k + 1) % 3).cast<double>() - a;
    const double length2 = edge.squaredNorm();
    const double along = length2 > 0.0 ? std::clamp((point - a).dot(edge) / length2, 0.0, 1.0) : 0.0;
    if ((point - a - along * edge).norm() < rounding) return true;
  }
  return false;
}

}  // namespace holdfast::surface
