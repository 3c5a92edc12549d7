// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

namespace holdfast {

/// A pose of the camera that something other than the images of its frame predicts, with its uncertainty.
struct PredictedPose {
  Eigen::Isometry3d T_camera_world = Eigen::Isometry3d::Identity();
  /// Of the error d in T_world_camera * exp(d): translation, in the unit of the map, and rotation [rad].
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

}  // namespace holdfast
