// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <span>

#include "holdfast/geometry/pinhole.hpp"

/// Warping of depth images between two views: projection of measured points into the other view, and test for free
/// space. In single precision, which suffices for depth images.
namespace holdfast::geometry {

/// Projection of a point into another view.
struct WarpedPoint {
  Eigen::Vector3f point;  ///< in the camera frame of the other view [m]; its z is the expected depth
  float x, y;             ///< pixel in the other view [px]; may lie outside its image
};

/// Projections of the pixels of a row into another view: entry i of each array belongs to pixel i.
struct WarpedRow {
  Eigen::ArrayXf z;     ///< depth in the other view [m]
  Eigen::ArrayXf x, y;  ///< pixel in the other view [px]
};

/// Warps pixels with depth from one view to another:
///
///   point = depth * R * (ray_x, ray_y, 1) + t,  x = fx * point.x / point.z + cx,  y = fy * point.y / point.z + cy
///
/// with R and t of T_to_from, a ray ((x - cx) / fx, (y - cy) / fy) of the first camera, and the intrinsics of the
/// second one. Immutable; any thread.
class Warp {
 private:
  /// Coordinate i of the point, for scalars or arrays, with the same order of operations for bit-identical results.
  template <class Numbers>
  auto coordinate(int i, const Numbers& ray_x, float ray_y, const Numbers& depth) const {
    return depth * R_(i, 0) * ray_x + (depth * R_(i, 1) * ray_y + depth * R_(i, 2)) + t_[i];
  }

 public:
  /// Points with a depth below `nearest` [m] in the second view are not projected.
  Warp(const Eigen::Isometry3d& T_to_from, const Pinhole& from, const Pinhole& to, float nearest = 0.1F)
      : R_(T_to_from.linear().cast<float>()),
        t_(T_to_from.translation().cast<float>()),
        from_(from),
        to_(to),
        minimum_depth_(nearest) {}
  /// Both views from one camera.
  Warp(const Eigen::Isometry3d& T_to_from, const Pinhole& camera, float nearest = 0.1F)
      : Warp(T_to_from, camera, camera, nearest) {}

  /// The ray of a column or row of the first view.
  float ray_x(float x) const { return (x - from_.cx) / from_.fx; }
  float ray_y(float y) const { return (y - from_.cy) / from_.fy; }

  /// Projection into the second view of a point on a ray of the first view at a depth [m] along its optical axis.
  std::optional<WarpedPoint> operator()(float ray_x, float ray_y, float depth) const {
    return project(
        {coordinate(0, ray_x, ray_y, depth), coordinate(1, ray_x, ray_y, depth), coordinate(2, ray_x, ray_y, depth)});
  }
  /// Projection into the second view of a point in its camera frame [m].
  std::optional<WarpedPoint> project(const Eigen::Vector3f& point) const {
    if (!is_visible(point.z())) return std::nullopt;
    const float inverse = 1.0F / point.z();
    return WarpedPoint{point, to_.fx * point.x() * inverse + to_.cx, to_.fy * point.y() * inverse + to_.cy};
  }
  /// Vectorised projection of a row of pixels, bit-identical to operator(); `rays_x` and `depth` have one entry per
  /// pixel. x and y are invalid where !is_visible(z), all values where depth is not positive.
  void row(const Eigen::Ref<const Eigen::ArrayXf>& rays_x, float ray_y, const Eigen::Ref<const Eigen::ArrayXf>& depth,
           WarpedRow& to) const {
    to.z = coordinate(2, rays_x, ray_y, depth);
    to.x = to_.fx * coordinate(0, rays_x, ray_y, depth) * (1.0F / to.z) + to_.cx;
    to.y = to_.fy * coordinate(1, rays_x, ray_y, depth) * (1.0F / to.z) + to_.cy;
  }
  /// Whether a point at depth z [m] in the second view is projected; its pixel may lie outside the image.
  bool is_visible(float z) const { return z >= minimum_depth_; }
  /// Projection into the second view of a point at infinity on a ray of the first view (rotation only).
  std::optional<WarpedPoint> project_direction(float ray_x, float ray_y) const {
    return project(R_ * Eigen::Vector3f(ray_x, ray_y, 1.0F));
  }

 private:
  struct Intrinsics {
    explicit Intrinsics(const Pinhole& camera)
        : fx(static_cast<float>(camera.fx)),
          fy(static_cast<float>(camera.fy)),
          cx(static_cast<float>(camera.cx)),
          cy(static_cast<float>(camera.cy)) {}
    float fx, fy, cx, cy;
  };

  Eigen::Matrix3f R_;
  Eigen::Vector3f t_;
  Intrinsics from_, to_;
  float minimum_depth_;
};

/// Free-space test (see-through): whether at least six of the 3 x 3 cells around a cell measured a depth of `limit` [m]
/// or more, and none a smaller one. The neighbourhood avoids false detections at depth edges due to small pose errors.
/// `depth`: row by row, 0 = no measurement; the cell must not lie on the border.
inline bool is_seen_through(std::span<const float> depth, int columns, int cell, float limit) {
  constexpr int enough = 6;
  int farther = 0;
  for (int row = -1; row <= 1; ++row)
    for (int column = -1; column <= 1; ++column) {
      const float measured = depth[static_cast<std::size_t>(cell + row * columns + column)];
      if (measured >= limit)
        ++farther;
      else if (measured > 0.0F)
        return false;
    }
  return farther >= enough;
}

}  // namespace holdfast::geometry
