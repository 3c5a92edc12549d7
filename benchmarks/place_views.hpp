// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/descriptor.hpp"
#include "holdfast/core/sensor_frame.hpp"

namespace holdfast {

/// What a camera saw from where: one frame of a recording, as place recognition and its judge need it.
struct PlaceView {
  double timestamp = 0.0;  ///< [s]
  DescriptorBlock descriptors;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();  ///< true
  std::vector<double> depth;                                         ///< on a grid of the image [m], 0 = no value
};

/// The depth of a frame on the grid of shared_view(), with its true pose; without descriptors.
PlaceView view_of(const Camera& camera, const SensorFrame& frame, const Eigen::Isometry3d& T_world_camera);

/// Views of a recording, evenly spaced in time.
struct PlaceRecording {
  std::string name;
  Camera camera;
  std::vector<PlaceView> views;
};

/// Every `step`-th frame with a true pose of the source, given in YAML as in a configuration; features by `orb` with
/// its defaults. Throws what configurations and sources throw.
PlaceRecording read_recording(const std::string& source, int step);

/// The share of what `a` measures that `b` sees too, by true poses and depth: points of a grid, of those with depth in
/// `a` the ones that fall into the image of `b` within 5 % (at least 0.05 m) of the depth measured there. 0 when the
/// optical axes differ by more than 60 degrees: nobody matches descriptors of such views.
double shared_view(const Camera& camera, const PlaceView& a, const PlaceView& b);

}  // namespace holdfast
