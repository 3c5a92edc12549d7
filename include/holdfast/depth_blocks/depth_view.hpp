// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/coarse_view.hpp"
#include "holdfast/core/frame.hpp"
#include "holdfast/geometry/warp.hpp"

namespace holdfast::depth_blocks {

/// The grid of blocks of a depth view: every second cell of the coarse view, with the rays through their centres.
struct BlockGrid {
  static constexpr int stride = 2;  ///< cells of the coarse view

  BlockGrid(const Camera& camera, const CoarseGrid& coarse);

  int size() const { return columns * rows; }
  /// Fractional column and row of an undistorted pixel; integers are the centres of blocks.
  float column_of(float x) const { return (x - first_x) * inverse_step; }
  float row_of(float y) const { return (y - first_y) * inverse_step; }

  /// Takes blocks of one view to another view of the same camera.
  geometry::Warp warp(const Eigen::Isometry3d& T_other_this) const { return {T_other_this, {fx, fy, cx, cy, 0.0}}; }
  /// Projection of the surface of a block with a depth [m].
  std::optional<geometry::WarpedPoint> warped(const geometry::Warp& warp, int column, int row, float depth) const {
    return warp(ray_x[static_cast<std::size_t>(column)], ray_y[static_cast<std::size_t>(row)], depth);
  }

  int columns = 0, rows = 0;
  float fx, fy, cx, cy;
  float first_x, first_y, inverse_step;
  std::vector<float> ray_x, ray_y;  ///< by column and row: x/z and y/z
};

/// Upper bound of the noise of a depth difference [m]: base + growth * depth^2.
struct DepthNoise {
  float base, growth;
  float at(float depth) const { return base + growth * depth * depth; }
};

/// A frame in blocks. Entry row * columns + column of every array belongs to a block.
struct DepthView {
  std::uint64_t frame_index = 0;
  double timestamp = 0.0;                                            ///< [s]
  Eigen::Isometry3d T_camera_world = Eigen::Isometry3d::Identity();  ///< once known
  std::vector<float> depth;                                          ///< [m], 0 = none
  std::vector<float> grey;                                           ///< mean of the block's pixels, 0 to 255
  std::vector<float> static_score;                                   ///< 1 = static, 0 = moving
};

/// Interpolated depth and brightness of a view at a position between blocks.
struct Surface {
  bool known = false;
  bool smooth = false;      ///< one surface: depth and its slopes are valid; otherwise only nearest and farthest
  float nearest, farthest;  ///< of the four blocks around [m]
  float depth;              ///< interpolated
  float depth_x, depth_y;   ///< slope [m per block]
  float grey;
  float grey_x, grey_y;  ///< slope [per block]
};

/// Creates depth views of frames.
class ViewMaker {
 public:
  explicit ViewMaker(const Camera& camera);

  const BlockGrid& grid() const { return grid_; }
  /// `colour` 8UC3 of the camera's size.
  void make(const Frame& frame, const cv::Mat& colour, DepthView& view) const;

 private:
  CoarseSampler sampler_;
  BlockGrid grid_;
};

/// Interpolates a view at fractional columns and rows.
Surface surface_at(const BlockGrid& grid, const DepthView& view, float column, float row);

/// The block with the surface of a feature, or -1. At a depth edge the block of the feature's pixel may belong to the
/// adjacent surface, so that the surrounding block with the depth of the feature is used.
int block_of(const BlockGrid& grid, const DepthView& view, const Frame& frame, std::size_t feature);

}  // namespace holdfast::depth_blocks
