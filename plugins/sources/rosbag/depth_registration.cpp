// SPDX-License-Identifier: BSD-3-Clause
#include "depth_registration.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace holdfast::rosbag_plugin {

namespace {

/// Begin and end of the pixels of a row or column whose centres lie between two positions or, if there are none, of the
/// pixel in the middle, as far as they are inside the image.
std::pair<int, int> covered(double first, double last, int size) {
  constexpr double outside = 1.0;  // far positions may be no integers
  const double begin = std::clamp(first, -outside, size + outside), end = std::clamp(last, -outside, size + outside);
  int from = static_cast<int>(std::ceil(begin)), to = static_cast<int>(std::ceil(end));
  if (to <= from) {
    from = static_cast<int>(std::lround(0.5 * (begin + end)));
    to = from + 1;
  }
  return {std::max(from, 0), std::min(to, size)};
}

}  // namespace

DepthRegistration::DepthRegistration(const Camera& depth, const Camera& colour, const Eigen::Isometry3d& T_colour_depth)
    : depth_(depth), colour_(colour), T_colour_depth_(T_colour_depth) {
  corners_.reserve(static_cast<std::size_t>(depth.width + 1) * static_cast<std::size_t>(depth.height + 1));
  for (int y = 0; y <= depth.height; ++y)
    for (int x = 0; x <= depth.width; ++x) {
      const Eigen::Vector2d pixel = depth.undistort({x - 0.5, y - 0.5});
      corners_.emplace_back(T_colour_depth.linear() * depth.normalised(pixel.x(), pixel.y()).homogeneous());
    }
}

bool DepthRegistration::project(const Eigen::Vector3d& point, Eigen::Vector2d& pixel) const {
  constexpr double nearest = 1e-3;
  if (point.z() < nearest) return false;
  pixel = colour_.project(point);
  if (!colour_.distortion.is_zero()) pixel = colour_.distort(pixel);
  return true;
}

cv::Mat DepthRegistration::apply(const cv::Mat& depth) const {
  cv::Mat registered(colour_.height, colour_.width, CV_32FC1, cv::Scalar(0.0));
  const Eigen::Vector3d shift = T_colour_depth_.translation();
  const auto row_length = static_cast<std::size_t>(depth_.width + 1);
  Eigen::Vector2d first, last;
  for (int y = 0; y < depth.rows; ++y) {
    const auto* row = depth.ptr<float>(y);
    for (int x = 0; x < depth.cols; ++x) {
      const double z = row[x];
      if (z <= 0.0) continue;
      const std::size_t corner = static_cast<std::size_t>(y) * row_length + static_cast<std::size_t>(x);
      const Eigen::Vector3d begin = corners_[corner] * z + shift, end = corners_[corner + row_length + 1] * z + shift;
      if (!project(begin, first) || !project(end, last)) continue;
      const auto [left, right] = covered(first.x(), last.x(), colour_.width);
      const auto [top, bottom] = covered(first.y(), last.y(), colour_.height);
      const auto value = static_cast<float>(0.5 * (begin.z() + end.z()));
      for (int v = top; v < bottom; ++v) {
        auto* to = registered.ptr<float>(v);
        for (int u = left; u < right; ++u)
          if (to[u] == 0.0F || value < to[u]) to[u] = value;
      }
    }
  }
  return registered;
}

}  // namespace holdfast::rosbag_plugin
