// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "holdfast/core/mesh_vertex.hpp"

namespace holdfast {

/// An indexed triangle mesh. The corners of a triangle are counter-clockwise as seen from free space.
struct TriangleMesh {
  std::vector<MeshVertex> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::string> classes;  ///< names by MeshVertex::label; empty: vertices have no class

  bool empty() const { return triangles.empty(); }
  const Eigen::Vector3f& corner(std::size_t triangle, int index) const {
    return vertices[triangles[triangle][static_cast<std::size_t>(index)]].position;
  }
  /// Half the cross product of two edges: its length is the area [m^2], its direction the normal.
  Eigen::Vector3d area_vector(std::size_t triangle) const;
  /// Sum of the areas of all triangles [m^2].
  double area() const;
};

/// Sets the normal of every vertex to the mean of those of its triangles, weighted by their areas.
void compute_normals(TriangleMesh& mesh);

/// Connected parts of a mesh, by shared vertices. A part is named by its first vertex.
struct MeshParts {
  explicit MeshParts(const TriangleMesh& mesh);

  std::vector<std::uint32_t> part;  ///< of each vertex
  std::vector<double> area;         ///< of each part [m^2], at the position of its first vertex
};

/// Removes triangles, and vertices without triangles. The order of what remains is unchanged.
void remove_triangles(TriangleMesh& mesh, const std::function<bool(const std::array<std::uint32_t, 3>&)>& is_removed);

/// Removes connected parts (by shared vertices) with an area below `smallest_area` [m^2], and vertices without
/// triangles. The order of what remains is unchanged.
void remove_small_parts(TriangleMesh& mesh, double smallest_area);

}  // namespace holdfast
