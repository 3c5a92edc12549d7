// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/cell_mask.hpp"

namespace holdfast {

/// Grid of a coarse view: square cells of `step` undistorted pixels that cover the field of view of the camera.
struct CoarseGrid {
  static constexpr int step = 4;  ///< [px]

  int columns = 0, rows = 0;
  float left = 0, top = 0;  ///< undistorted pixel at the outer corner of cell (0, 0)

  int size() const { return columns * rows; }
  /// Undistorted pixel at the centre of a cell.
  float x_of(int column) const { return left + static_cast<float>(step) * (static_cast<float>(column) + 0.5F); }
  float y_of(int row) const { return top + static_cast<float>(step) * (static_cast<float>(row) + 0.5F); }
  /// The column or row that holds an undistorted pixel; outside the grid it is negative or too large.
  int column_of(float x) const { return to_cell(x - left); }
  int row_of(float y) const { return to_cell(y - top); }
  /// Index of the cell that holds an undistorted pixel, or -1.
  int cell_of(float x, float y) const {
    const int column = column_of(x), row = row_of(y);
    return column < 0 || row < 0 || column >= columns || row >= rows ? -1 : row * columns + column;
  }
  friend bool operator==(const CoarseGrid&, const CoarseGrid&) = default;

 private:
  static int to_cell(float offset) {
    return offset < 0.0F ? -1 : static_cast<int>(std::min(offset, 1e6F) * (1.0F / static_cast<float>(step)));
  }
};

/// Depth image of a frame on a coarse grid of undistorted pixels, with mask and static log-odds of each cell, for dense
/// comparisons between views. Cell (column, row) is entry row * columns + column of each array.
struct CoarseView {
  CoarseGrid grid;
  /// Pose of the depth image relative to the camera's pose: sensors expose colour and depth some milliseconds apart.
  /// Frame::T_view_world() applies it.
  Eigen::Isometry3d T_view_camera = Eigen::Isometry3d::Identity();
  std::vector<float> depth;            ///< along the optical axis at the cell's centre [m], 0 = none
  std::vector<float> static_log_odds;  ///< of the surface in the cell: positive = static, 0 = unknown; may be empty
  CellMask mask;                       ///< propagated mask, replaced by the frame's own segmentation when that arrives

  bool empty() const { return depth.empty(); }
  /// Pose of the depth image when the camera has the given pose: T_view_camera * T_camera_world.
  Eigen::Isometry3d T_view_world(const Eigen::Isometry3d& T_camera_world) const;
};

/// Samples images at the cells of a camera's coarse view. Immutable after construction; any thread.
class CoarseSampler {
 public:
  explicit CoarseSampler(const Camera& camera);

  const CoarseGrid& grid() const { return grid_; }
  /// Samples view.depth from a depth image of the camera's size (32FC1 [m]; empty = no depth anywhere). A cell gets the
  /// depth of the pixel at its centre or, if that is missing, of one of the four neighbouring pixels. Clears the
  /// log-odds and the mask.
  void sample_depth(const cv::Mat& depth, CoarseView& view) const;
  /// Samples labels (8UC1 of the camera's size) at the centres of the cells. Cells outside the image get the label
  /// `outside`.
  void sample_labels(const cv::Mat& labels, std::uint8_t outside, std::vector<std::uint8_t>& cells) const;
  /// Sets all raw pixels of the marked cells (not 0, one entry per cell) to 255 in an image of the camera's size, 8UC1;
  /// empty if no cell is marked.
  cv::Mat pixels_of(const std::vector<std::uint8_t>& marked) const;
  /// Raw pixel at the centre of a cell as row * width + column, or -1 outside the image.
  std::int32_t raw_pixel(int cell) const { return raw_[static_cast<std::size_t>(cell)]; }

 private:
  /// Depth of one of the four neighbours of a pixel without depth; 0 if none has depth.
  float measured_beside(const float* depth, std::int32_t pixel) const;

  int width_, height_;
  CoarseGrid grid_;
  std::vector<std::int32_t> raw_;
};

}  // namespace holdfast
