// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/coarse_view.hpp"
#include "holdfast/core/frame.hpp"

namespace holdfast::test {

/// A wall, a floor and boxes along the axes, as exact depth on coarse views: dense geometry without images. World axes
/// are those of a camera at the identity.
class BoxWorld {
 public:
  struct Box {
    Eigen::Vector3d minimum, maximum;
    std::uint8_t label = 1;
  };
  static Box box(const Eigen::Vector3d& centre, const Eigen::Vector3d& half_size, std::uint8_t label = 1) {
    return {centre - half_size, centre + half_size, label};
  }

  Camera camera;  // its distortion counts for images, not for coarse views
  double wall_z = 3.0, floor_y = std::numeric_limits<double>::infinity();
  std::vector<Box> boxes;

  struct Hit {
    double depth = 0.0;      // along the optical axis [m]
    std::uint8_t label = 0;  // of the box, 0 = wall or floor
    bool floor = false;
  };
  /// What is seen at an undistorted pixel.
  Hit look(const Eigen::Isometry3d& T_world_camera, double x, double y) const {
    const Eigen::Vector3d origin = T_world_camera.translation();
    const Eigen::Vector3d ray = T_world_camera.linear() * camera.back_project(x, y, 1.0);
    Hit hit{std::numeric_limits<double>::infinity(), 0, false};
    const auto offer = [&](double depth, std::uint8_t label, bool floor) {
      if (depth > 0.05 && depth < hit.depth) hit = {depth, label, floor};
    };
    if (ray.z() > 0.0) offer((wall_z - origin.z()) / ray.z(), 0, false);
    if (ray.y() > 0.0) offer((floor_y - origin.y()) / ray.y(), 0, true);
    for (const Box& each : boxes) {
      double enter = 0.0, leave = std::numeric_limits<double>::infinity();
      for (int axis = 0; axis < 3; ++axis) {
        const double a = (each.minimum[axis] - origin[axis]) / ray[axis];
        const double b = (each.maximum[axis] - origin[axis]) / ray[axis];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
      }
      if (enter <= leave) offer(enter, each.label, false);
    }
    if (hit.depth == std::numeric_limits<double>::infinity()) hit.depth = 0.0;
    return hit;
  }

  /// The coarse view from a pose, and the true labels of its cells.
  CoarseView view(const Eigen::Isometry3d& T_world_camera, std::vector<std::uint8_t>* labels = nullptr) const {
    CoarseView view;
    view.grid = CoarseSampler(camera).grid();
    if (labels != nullptr) labels->clear();
    for (int row = 0; row < view.grid.rows; ++row)
      for (int column = 0; column < view.grid.columns; ++column) {
        const Hit hit = look(T_world_camera, view.grid.x_of(column), view.grid.y_of(row));
        view.depth.push_back(static_cast<float>(hit.depth));
        if (labels != nullptr) labels->push_back(hit.label);
      }
    return view;
  }

  /// A frame with a feature every `spacing` pixels, each with the depth that the world has there.
  Frame frame(const Eigen::Isometry3d& T_world_camera, double timestamp, int spacing = 10) const {
    Frame frame;
    frame.timestamp = timestamp;
    frame.camera = std::make_shared<Camera>(camera);
    frame.pyramid = std::make_shared<ScalePyramid>();
    frame.coarse = view(T_world_camera);
    frame.T_camera_world = T_world_camera.inverse();
    for (int y = spacing; y + spacing < camera.height; y += spacing)
      for (int x = spacing; x + spacing < camera.width; x += spacing) {
        frame.x.push_back(static_cast<float>(x)), frame.y.push_back(static_cast<float>(y));
        frame.depth.push_back(static_cast<float>(look(T_world_camera, x, y).depth));
      }
    const std::size_t count = frame.x.size();
    frame.features.resize(count);
    frame.features.x = frame.x, frame.features.y = frame.y;
    frame.right_x.assign(count, std::numeric_limits<float>::quiet_NaN());
    frame.map_points.assign(count, MapPointId());
    frame.static_probability.assign(count, 1.0F);
    frame.measured_log_odds.assign(count, 0.0F);
    return frame;
  }
};

}  // namespace holdfast::test
