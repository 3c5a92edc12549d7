// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "holdfast/core/frame.hpp"

namespace holdfast {

/// Image points followed from frame to frame by pyramidal Lucas-Kanade flow at half resolution (Bouguet 2000). Points
/// are added where the caller wants them and keep rising ids; those that are lost disappear. One thread.
class PointFollower {
 public:
  /// Entry i of each array belongs to point i; ordered by id.
  struct Points {
    std::vector<std::uint64_t> id;
    std::vector<float> raw_x, raw_y;  ///< raw pixel of the full image
    std::vector<float> x, y;          ///< undistorted pixel
    std::vector<float> depth;         ///< [m], 0 = none
    std::vector<std::uint8_t> label;  ///< as the caller sees fit

    std::size_t size() const { return id.size(); }
  };

  /// Moves the points to a new image (8UC1) of `camera`; `frame` gives the depth.
  void advance(const cv::Mat& grey, const Frame& frame);
  /// How much of a corner the last image has at a raw pixel; 0 = nothing to follow.
  int corner_strength(int raw_x, int raw_y) const;
  /// Adds a point at a raw pixel of the last image.
  void add(const Frame& frame, float raw_x, float raw_y, std::uint8_t label);
  /// Keeps the points for which `keep` says so.
  template <class Keep>
  void filter(const Keep& keep);

  const Points& points() const { return points_; }
  std::uint8_t& label(std::size_t point) { return points_.label[point]; }

 private:
  void compact(const std::vector<std::uint8_t>& keep);

  Points points_;
  std::uint64_t next_id_ = 0;
  cv::Mat half_;
  std::vector<cv::Mat> pyramid_, previous_pyramid_;
  std::vector<cv::Point2f> before_, after_, step_;
  std::vector<std::uint8_t> found_;
  std::vector<float> error_;
};

inline int PointFollower::corner_strength(int raw_x, int raw_y) const {
  // The finest level of the pyramid is followed by its derivatives.
  const cv::Mat& derivatives = pyramid_[1];
  const int column = raw_x / 2, row = raw_y / 2;
  if (raw_x < 0 || raw_y < 0 || column >= derivatives.cols || row >= derivatives.rows) return 0;
  const std::int16_t* gradient = derivatives.ptr<std::int16_t>(row) + std::ptrdiff_t{2} * column;
  return std::min(std::abs(gradient[0]), std::abs(gradient[1]));
}

template <class Keep>
void PointFollower::filter(const Keep& keep) {
  std::vector<std::uint8_t> kept(points_.size());
  for (std::size_t i = 0; i < points_.size(); ++i) kept[i] = keep(i) ? 1 : 0;
  compact(kept);
}

}  // namespace holdfast
