// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/triangle_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <vector>

namespace holdfast {

namespace {

/// Disjoint sets (Tarjan 1975) with path halving; the smallest member represents a set.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parents_(count) { std::iota(parents_.begin(), parents_.end(), 0U); }
  std::uint32_t find(std::uint32_t member) {
    while (parents_[member] != member) member = parents_[member] = parents_[parents_[member]];
    return member;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a), b = find(b);
    parents_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parents_;
};

}  // namespace

Eigen::Vector3d TriangleMesh::area_vector(std::size_t triangle) const {
  const Eigen::Vector3d a = corner(triangle, 0).cast<double>(), b = corner(triangle, 1).cast<double>();
  return 0.5 * (b - a).cross(corner(triangle, 2).cast<double>() - a);
}

double TriangleMesh::area() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < triangles.size(); ++i) sum += area_vector(i).norm();
  return sum;
}

void compute_normals(TriangleMesh& mesh) {
  for (MeshVertex& vertex : mesh.vertices) vertex.normal.setZero();
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Eigen::Vector3f area = mesh.area_vector(i).cast<float>();
    for (const std::uint32_t corner : mesh.triangles[i]) mesh.vertices[corner].normal += area;
  }
  for (MeshVertex& vertex : mesh.vertices)
    if (const float length = vertex.normal.norm(); length > 0.0F) vertex.normal /= length;
}

MeshParts::MeshParts(const TriangleMesh& mesh) : part(mesh.vertices.size()), area(mesh.vertices.size(), 0.0) {
  DisjointSets sets(mesh.vertices.size());
  for (const auto& triangle : mesh.triangles) {
    sets.join(triangle[0], triangle[1]);
    sets.join(triangle[0], triangle[2]);
  }
  for (std::uint32_t i = 0; i < part.size(); ++i) part[i] = sets.find(i);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    area[part[mesh.triangles[i][0]]] += mesh.area_vector(i).norm();
}

void remove_small_parts(TriangleMesh& mesh, double smallest_area) {
  const MeshParts parts(mesh);
  remove_triangles(mesh, [&](const auto& triangle) { return parts.area[parts.part[triangle[0]]] < smallest_area; });
}

void remove_triangles(TriangleMesh& mesh, const std::function<bool(const std::array<std::uint32_t, 3>&)>& is_removed) {
  std::erase_if(mesh.triangles, is_removed);
  constexpr std::uint32_t unused = 0xFFFFFFFF;
  std::vector<std::uint32_t> numbers(mesh.vertices.size(), unused);
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle) numbers[corner] = 0;
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (numbers[i] != unused) {
      mesh.vertices[count] = mesh.vertices[i];
      numbers[i] = count++;
    }
  mesh.vertices.resize(count);
  for (auto& triangle : mesh.triangles)
    for (std::uint32_t& corner : triangle) corner = numbers[corner];
}

}  // namespace holdfast
