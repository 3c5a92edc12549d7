// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "posed_world.hpp"

namespace holdfast::simulation {

/// A triangle as the camera sees it. Every attribute is linear in the ray r = (x, y, 1) when divided by depth:
/// attribute / z = gradient . r, and 1 / z = inverse_depth . r.
struct VisibleTriangle {
  Eigen::Vector3d inverse_depth;
  Eigen::Vector3f u, v, light;
  const Texture* texture = nullptr;
  std::uint16_t object = 0;   ///< index plus one
  bool floor = false;         ///< of a floor or rug that stands still: contact shadows fall on it
  float inverse_norm = 1.0F;  ///< 1 / |inverse_depth|, which points along the normal
};

/// Rays of a regular grid: column i and row j look along (x0 + i step_x, y0 + j step_y, 1).
struct RayGrid {
  int columns = 0, rows = 0;
  double x0 = 0, y0 = 0, step_x = 0, step_y = 0;
};

/// Which triangle each ray of a grid meets first.
class VisibilityBuffer {
 public:
  static constexpr std::uint32_t nothing = 0xffffffffU;
  static constexpr double near_plane = 0.05;  ///< nothing nearer is drawn [m]

  explicit VisibilityBuffer(const RayGrid& grid);

  /// Finds what is visible from T_world_camera. Faces turned away are not drawn.
  void draw(const PosedWorld& world, const Eigen::Isometry3d& T_world_camera);

  const RayGrid& grid() const { return grid_; }
  const std::vector<VisibleTriangle>& triangles() const { return triangles_; }
  /// Of each triangle: one number for all triangles of a smooth surface.
  const std::vector<std::uint32_t>& surfaces() const { return surfaces_; }
  /// Number into triangles() or `nothing`.
  const std::uint32_t* row(int j) const { return numbers_.data() + static_cast<std::size_t>(j) * grid_.columns; }
  /// 1 / depth [1/m], 0 where nothing is.
  const float* inverse_depths(int j) const { return nearest_.data() + static_cast<std::size_t>(j) * grid_.columns; }

 private:
  /// The sphere [camera frame, m] lies beyond one side of the view or before the near plane.
  bool outside(const Eigen::Vector3d& centre, double radius) const;
  /// All corners lie beyond one side of the view: a plane through the eye, so this holds behind the camera too.
  bool outside(const Eigen::Vector3d corners[3]) const;
  void draw_triangle(const Eigen::Vector3d corners[3], const Eigen::Matrix3d& edges, std::uint32_t number);

  RayGrid grid_;
  std::vector<float> nearest_;
  std::vector<std::uint32_t> numbers_;
  std::vector<VisibleTriangle> triangles_;
  std::vector<std::uint32_t> surfaces_;
  std::array<Eigen::Vector3d, 4> sides_;  // unit normals of the planes through the eye that bound the view, inwards
  std::vector<Eigen::Vector3d> corners_;  // of the object being drawn, camera frame
  std::vector<std::pair<double, std::uint32_t>> order_;  // of the objects in view: distance and index
};

}  // namespace holdfast::simulation
