// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "holdfast/surface/triangle_mesh.hpp"

namespace holdfast {

/// Exact nearest points on a mesh, by a tree of bounding boxes that is split at the median. The mesh must outlive the
/// tree, and be unchanged. Any thread.
class TriangleTree {
 public:
  /// The point of the mesh that is nearest to another point, and its triangle.
  struct Nearest {
    double distance = std::numeric_limits<double>::infinity();  ///< [m]
    std::size_t triangle = 0;
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
  };

  explicit TriangleTree(const TriangleMesh& mesh);

  /// The nearest point closer than `limit` [m]; the distance is infinite if there is none.
  Nearest nearest(const Eigen::Vector3d& point, double limit = std::numeric_limits<double>::infinity()) const;

  /// A crossing of a line with the mesh.
  struct Crossing {
    double along = 0.0;  ///< signed distance from the origin of the line [m]
    std::size_t triangle = 0;
  };
  /// The crossings of a line with the mesh (Moeller and Trumbore, JGT 1997) up to `reach` [m] to both sides of its
  /// origin, in no particular order. `direction` has unit length.
  std::vector<Crossing> crossings(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double reach) const;

 private:
  struct Node {
    Eigen::AlignedBox3f box;
    std::uint32_t begin = 0, end = 0;  // in order_, of a leaf
    std::uint32_t second = 0;          // child, of an inner node; the first one follows it
  };
  void build(std::uint32_t begin, std::uint32_t end);
  std::optional<double> crossing_of(std::size_t triangle, const Eigen::Vector3d& origin,
                                    const Eigen::Vector3d& direction) const;

  const TriangleMesh& mesh_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

/// The point of a triangle that is nearest to `point` (Ericson, Real-Time Collision Detection, 2005, section 5.1.5).
Eigen::Vector3d nearest_on_triangle(const Eigen::Vector3d& point, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                    const Eigen::Vector3d& c);

}  // namespace holdfast
