// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "holdfast/core/frame.hpp"

namespace holdfast::geometry {

/// Where a map point is expected in a frame.
struct ExpectedView {
  Eigen::Vector2d pixel;  ///< undistorted
  double right_x = 0.0;   ///< column in the virtual right image [px]
  int level = 0;          ///< of the pyramid
};

/// Nothing when the point is outside the image, at a distance from which its descriptor is not found, or seen from more
/// than 60 degrees off its mean viewing direction (Mur-Artal et al. 2015, section V-D). Position and direction in the
/// world frame, distances in metres. Of the frame only camera, grid and pyramid count.
inline std::optional<ExpectedView> expected_view(const Frame& frame, const Eigen::Isometry3d& T_camera_world,
                                                 const Eigen::Vector3d& position, const Eigen::Vector3d& direction,
                                                 float minimum_distance, float maximum_distance) {
  constexpr double nearest = 0.05;      // m
  constexpr double least_cosine = 0.5;  // of the angle to the mean viewing direction
  const Eigen::Vector3d in_camera = T_camera_world * position;
  if (!(in_camera.z() > nearest)) return std::nullopt;
  ExpectedView view;
  view.pixel = frame.camera->project(in_camera);
  if (!frame.grid.covers(static_cast<float>(view.pixel.x()), static_cast<float>(view.pixel.y()))) return std::nullopt;
  const double distance = in_camera.norm();
  if (distance < 0.8 * minimum_distance || distance > 1.2 * maximum_distance) return std::nullopt;
  if (in_camera.dot(T_camera_world.linear() * direction) < least_cosine * distance) return std::nullopt;
  view.right_x = frame.camera->right_x(view.pixel.x(), in_camera.z());
  view.level = frame.pyramid->predict_level(maximum_distance, distance);
  return view;
}

}  // namespace holdfast::geometry
