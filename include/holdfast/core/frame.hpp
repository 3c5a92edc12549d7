// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/coarse_view.hpp"
#include "holdfast/core/feature_grid.hpp"
#include "holdfast/core/features.hpp"
#include "holdfast/core/id.hpp"
#include "holdfast/core/scale_pyramid.hpp"

namespace holdfast {

/// The features of one image with all that tracking knows of them, as a structure of arrays. Entry i of every array
/// belongs to feature i. Moved into a KeyFrame when the frame becomes one.
struct Frame {
  std::uint64_t index = 0;  ///< SensorFrame::index
  double timestamp = 0.0;   ///< [s]
  std::shared_ptr<const Camera> camera;
  std::shared_ptr<const ScalePyramid> pyramid;

  Features features;                      ///< raw positions, octaves, angles, descriptors
  std::vector<float> x;                   ///< undistorted column [px]
  std::vector<float> y;                   ///< undistorted row [px]
  std::vector<float> depth;               ///< along the optical axis [m], 0 = none
  std::vector<float> right_x;             ///< column in the virtual right image [px], NaN = none
  std::vector<MapPointId> map_points;     ///< the map point that the feature shows, or an invalid id
  std::vector<float> static_probability;  ///< 1 = certainly part of the static world
  /// What was measured of each feature's standing still, now and earlier; priors of classes apart. 0 = nothing.
  std::vector<float> measured_log_odds;
  FeatureGrid grid;                       ///< of the undistorted positions
  CoarseView coarse;                      ///< the depth image on a coarse grid, and what is known of its parts

  Eigen::Isometry3d T_camera_world = Eigen::Isometry3d::Identity();

  std::size_t size() const { return features.size(); }
  Eigen::Isometry3d T_world_camera() const { return T_camera_world.inverse(); }
  bool has_depth(std::size_t feature) const { return depth[feature] > 0.0F; }
  /// The feature's point in the camera frame; it must have depth.
  Eigen::Vector3d camera_point(std::size_t feature) const {
    return camera->back_project(x[feature], y[feature], depth[feature]);
  }
};

}  // namespace holdfast
