// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "holdfast/surface/triangle_mesh.hpp"

namespace holdfast::surface {

/// The edges of a mesh that belong to one triangle only, where vertices at the same position are one. The mesh must
/// outlive it, and be unchanged.
class MeshBorder {
 public:
  explicit MeshBorder(const TriangleMesh& mesh);

  /// Whether a point of a triangle lies on the border.
  bool contains(std::size_t triangle, const Eigen::Vector3d& point) const;

 private:
  const TriangleMesh& mesh_;
  std::vector<std::array<bool, 3>> edge_;    // of each triangle, from corner k to the next one
  std::vector<std::array<bool, 3>> corner_;  // of each triangle: whether a border edge ends there
};

}  // namespace holdfast::surface
