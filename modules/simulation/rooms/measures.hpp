// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/core/types.hpp>

/// Measures that all rooms and their furniture share.
namespace holdfast::simulation {

inline constexpr double table_top = 0.73;  ///< height of desks and tables [m]
inline constexpr double quarter_turn = 1.57079632679;

/// From one corner to the opposite one [m].
inline Eigen::AlignedBox3f box(double x0, double y0, double z0, double x1, double y1, double z1) {
  return {Eigen::Vector3f(Eigen::Vector3d(x0, y0, z0).cast<float>()),
          Eigen::Vector3f(Eigen::Vector3d(x1, y1, z1).cast<float>())};
}

/// Size of a texture for a surface of `width` by `height` [m], `density` texels per metre.
inline cv::Size texels(double width, double height, double density) {
  return {std::max(4, static_cast<int>(std::lround(width * density))),
          std::max(4, static_cast<int>(std::lround(height * density)))};
}

}  // namespace holdfast::simulation
