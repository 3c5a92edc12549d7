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

/// The features of one image and the state of tracking for each, as a structure of arrays: entry i of every array
/// belongs to feature i. All positions are of the left (or only) colour image.
///
/// Writers, in this order: FrameBuilder fills everything up to `right_x`, the grid and coarse.depth, and resets the
/// rest. MovingWorld writes coarse.mask before features are extracted; then static_probability, measured_log_odds,
/// coarse.static_log_odds and coarse.T_view_camera while the frame is tracked. The tracker writes map_points and
/// T_camera_world. When the frame becomes a keyframe, Map stores a copy. Map and the local mapper then change
/// map_points and T_camera_world of the copy; mask and static_probability are updated when the segmentation of the
/// keyframe arrives. `image_descriptor` is written by tracking for a lost frame, and by loop closing for a keyframe.
struct Frame {
  std::uint64_t index = 0;  ///< SensorFrame::index
  double timestamp = 0.0;   ///< of the colour image [s]
  std::shared_ptr<const Camera> camera;
  std::shared_ptr<const ScalePyramid> pyramid;

  Features features;                      ///< raw positions, octaves, angles, descriptors
  std::vector<float> x;                   ///< undistorted column [px]
  std::vector<float> y;                   ///< undistorted row [px]
  std::vector<float> depth;               ///< along the optical axis [m], 0 = none
  std::vector<float> right_x;             ///< column in the virtual right image [px], NaN = none
  std::vector<MapPointId> map_points;     ///< matched map point, or an invalid id
  std::vector<float> static_probability;  ///< probability of belonging to the static world; the weight of the feature
  /// Accumulated static log-odds from measurements only, of this frame and of the matched map point; class priors are
  /// excluded. 0 = nothing was measured.
  std::vector<float> measured_log_odds;
  FeatureGrid grid;   ///< of the undistorted positions
  CoarseView coarse;  ///< the depth image on a coarse grid, its mask and its evidence
  /// Global image descriptor for place recognition, if the loop detector uses one; empty before its computation.
  DescriptorBlock image_descriptor;

  Eigen::Isometry3d T_camera_world = Eigen::Isometry3d::Identity();
  /// Standard deviation of the position relative to the frames before, by inertial measurements, in the unit of the
  /// map; 0 = unknown. Not saved in map files.
  double inertial_deviation = 0.0;

  std::size_t size() const { return features.size(); }
  Eigen::Isometry3d T_world_camera() const;
  /// Pose of the camera at the exposure of the depth image, for comparisons of depth between frames and keyframes.
  Eigen::Isometry3d T_view_world() const;
  bool has_depth(std::size_t feature) const { return depth[feature] > 0.0F; }
  /// Position of the feature in the camera frame [m]; it must have depth.
  Eigen::Vector3d camera_point(std::size_t feature) const {
    return camera->back_project(x[feature], y[feature], depth[feature]);
  }
};

}  // namespace holdfast
