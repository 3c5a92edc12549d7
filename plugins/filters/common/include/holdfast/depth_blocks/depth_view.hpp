// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/coarse_view.hpp"
#include "holdfast/core/frame.hpp"

namespace holdfast::depth_blocks {

/// Where the blocks of a depth view lie: every second cell of the coarse view, with the rays through their centres.
struct BlockGrid {
  static constexpr int stride = 2;  ///< cells of the coarse view

  BlockGrid(const Camera& camera, const CoarseGrid& coarse);

  int size() const { return columns * rows; }
  /// Column and row of an undistorted pixel, as fractions: whole numbers are the centres of blocks.
  float column_of(float x) const { return (x - first_x) * inverse_step; }
  float row_of(float y) const { return (y - first_y) * inverse_step; }

  int columns = 0, rows = 0;
  float fx, fy, cx, cy;
  float first_x, first_y, inverse_step;
  std::vector<float> ray_x, ray_y;  ///< by column and row: x/z and y/z
};

/// Limit of what noise makes of a difference of two depths [m]: base + growth * depth^2.
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
  std::vector<float> static_score;                                   ///< 1 = stands still, 0 = moves
};

/// What a view shows at a place between blocks.
struct Surface {
  bool known = false;
  bool smooth = false;      ///< one surface: depth and its slopes mean something; else only nearest and farthest do
  float nearest, farthest;  ///< of the four blocks around [m]
  float depth;              ///< interpolated
  float depth_x, depth_y;   ///< slope [m per block]
  float grey;
  float grey_x, grey_y;  ///< slope [per block]
};

/// Makes views of frames.
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

/// Looks a view up at fractions of columns and rows.
Surface surface_at(const BlockGrid& grid, const DepthView& view, float column, float row);

/// The block that shows what a feature shows, or -1: at an edge the block below the feature may show what is beside, so
/// of those around it the one at the feature's own depth is taken.
int block_of(const BlockGrid& grid, const DepthView& view, const Frame& frame, std::size_t feature);

}  // namespace holdfast::depth_blocks
