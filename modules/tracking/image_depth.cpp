// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/image_depth.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <string>

#include "holdfast/core/error.hpp"
#include "holdfast/core/size_text.hpp"
#include "holdfast/geometry/warp.hpp"

namespace holdfast {

void ImageDepth::check_images(const SensorFrame& sensor_frame) const {
  const cv::Mat& depth = sensor_frame.depth;
  if (!depth.empty() && (depth.type() != CV_32FC1 || depth.size() != sensor_frame.colour.size()))
    throw InputError({"frame " + std::to_string(sensor_frame.index)},
                     "the depth image is " + size_text(depth.cols, depth.rows) +
                         "; expected one 32 bit float channel [m] of the colour image's size");
}

/// The depth at a raw pixel; 0 without a measurement, outside the image, or at a depth edge. Elsewhere it is the mean
/// of the pixel and of opposite pairs of neighbours, which has less noise and, on a slanted plane, the same value.
float ImageDepth::depth_at(const cv::Mat& depth, float x, float y) const {
  // A position far outside the image does not fit an integer.
  if (!(x > -0.5F) || !(y > -0.5F) || !(x < static_cast<float>(depth.cols)) || !(y < static_cast<float>(depth.rows)))
    return 0.0F;
  const int column = static_cast<int>(x + 0.5F), row = static_cast<int>(y + 0.5F);
  if (column >= depth.cols || row >= depth.rows) return 0.0F;
  const float value = depth.at<float>(row, column);
  if (!is_measured_depth(value)) return 0.0F;
  if (edge_ratio_ <= 0.0) return value;
  // Pairs of opposite neighbours; 0 = not measured. Without branches, because most of them are measured, but not
  // predictably so.
  constexpr int reach = 2;
  constexpr std::array<int, 4> column_steps{reach, -reach, 0, reach}, row_steps{0, reach, reach, reach};
  const bool is_inside = column >= reach && row >= reach && column + reach < depth.cols && row + reach < depth.rows;
  const auto at = [&](int c, int r) {
    if (!is_inside && (c < 0 || r < 0 || c >= depth.cols || r >= depth.rows)) return 0.0F;
    const float neighbour = depth.at<float>(r, c);
    return is_measured_depth(neighbour) ? neighbour : 0.0F;
  };
  std::array<float, 4> one{}, other{};
  for (std::size_t i = 0; i < one.size(); ++i) {
    one[i] = at(column + column_steps[i], row + row_steps[i]);
    other[i] = at(column - column_steps[i], row - row_steps[i]);
  }
  // At a depth edge the feature may lie on either surface, so that its depth is unknown.
  float nearest = value, farthest = value, sum = value;
  int count = 1;
  for (std::size_t i = 0; i < one.size(); ++i) {
    for (const float neighbour : {one[i], other[i]}) {
      nearest = std::min(nearest, neighbour > 0.0F ? neighbour : nearest);
      farthest = std::max(farthest, neighbour);
    }
    const bool both = one[i] > 0.0F && other[i] > 0.0F;
    sum += both ? one[i] + other[i] : 0.0F;
    count += both ? 2 : 0;
  }
  return farthest - nearest > edge_ratio_ * value ? 0.0F : sum / static_cast<float>(count);
}

void ImageDepth::set_depth(std::size_t feature, float depth, Frame& frame) const {
  const float fx_baseline = static_cast<float>(camera_.fx * camera_.baseline);
  frame.depth[feature] = depth;
  frame.right_x[feature] =
      depth > 0.0F ? frame.x[feature] - fx_baseline / depth : std::numeric_limits<float>::quiet_NaN();
}

void ImageDepth::read(const SensorFrame& sensor_frame, Frame& frame) {
  const cv::Mat& depth = sensor_frame.depth;
  const std::size_t count = frame.size();
  frame.depth.assign(count, 0.0F);
  frame.right_x.assign(count, std::numeric_limits<float>::quiet_NaN());
  if (depth.empty()) return;
  for (std::size_t i = 0; i < count; ++i) {
    const float x = std::clamp(frame.features.x[i], 0.0F, static_cast<float>(depth.cols - 1));
    const float y = std::clamp(frame.features.y[i], 0.0F, static_cast<float>(depth.rows - 1));
    set_depth(i, depth_at(depth, x, y), frame);
  }
}

void ImageDepth::align(const SensorFrame& sensor_frame, const Eigen::Isometry3d& T_depth_colour, Frame& frame) {
  const cv::Mat& depth = sensor_frame.depth;
  if (depth.empty()) return;
  constexpr float typical_depth = 2.0F, min_depth = 0.1F;  // m
  const geometry::Pinhole pinhole = geometry::pinhole_of(camera_);
  const geometry::Warp to_depth(T_depth_colour, pinhole, min_depth);
  const geometry::Warp to_colour(T_depth_colour.inverse(), pinhole, min_depth);
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const float guess = frame.has_depth(i) ? frame.depth[i] : typical_depth;
    float aligned = 0.0F;
    if (const auto seen = to_depth(to_depth.ray_x(frame.x[i]), to_depth.ray_y(frame.y[i]), guess)) {
      const Eigen::Vector2d raw = camera_.distort({seen->x, seen->y});
      const float measured = depth_at(depth, static_cast<float>(raw.x()), static_cast<float>(raw.y()));
      if (measured > 0.0F)
        if (const auto back = to_colour(to_colour.ray_x(seen->x), to_colour.ray_y(seen->y), measured))
          aligned = back->point.z();
    }
    set_depth(i, aligned, frame);
  }
}

}  // namespace holdfast
