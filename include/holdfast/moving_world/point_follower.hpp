// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/optical_flow/point_flow.hpp"

namespace holdfast {

/// Image points tracked from frame to frame by optical flow (follow_points()), predicted with constant image velocity.
/// Points are added by the caller and get increasing ids; lost points are removed. One thread.
class PointFollower {
 public:
  /// Entry i of each array belongs to point i; ordered by id.
  struct Points {
    std::vector<std::uint64_t> id;
    std::vector<float> raw_x, raw_y;  ///< raw pixel of the full image
    std::vector<float> x, y;          ///< undistorted pixel
    std::vector<float> depth;         ///< [m], 0 = none
    std::vector<std::uint8_t> label;  ///< assigned by the caller

    std::size_t size() const { return id.size(); }
  };

  /// Moves the points to a new image (8UC1) of `camera`; `frame` gives the depth.
  void advance(const cv::Mat& grey, const Frame& frame);
  /// Corner strength of the last image at a raw pixel; 0 = no texture.
  int corner_strength(int raw_x, int raw_y) const { return holdfast::corner_strength(image_, raw_x / 2, raw_y / 2); }
  /// Adds a point at a raw pixel of the last image.
  void add(const Frame& frame, float raw_x, float raw_y, std::uint8_t label);
  /// Keeps the points for which `keep` returns true.
  template <class Keep>
  void filter(const Keep& keep);

  const Points& points() const { return points_; }
  std::uint8_t& label(std::size_t point) { return points_.label[point]; }

 private:
  void compact(const std::vector<std::uint8_t>& keep);

  Points points_;
  std::uint64_t next_id_ = 0;
  ImagePyramid image_, last_image_;
  PointFlow flow_;
  std::vector<float> step_x_, step_y_;  // of the last image [px]
};

template <class Keep>
void PointFollower::filter(const Keep& keep) {
  std::vector<std::uint8_t> kept(points_.size());
  for (std::size_t i = 0; i < points_.size(); ++i) kept[i] = keep(i) ? 1 : 0;
  compact(kept);
}

}  // namespace holdfast
