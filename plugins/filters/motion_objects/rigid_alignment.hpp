// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "holdfast/depth_blocks/depth_view.hpp"

namespace holdfast::object_plugin {

using depth_blocks::BlockGrid;
using depth_blocks::DepthNoise;
using depth_blocks::DepthView;

/// A motion of a thing between two frames: p_then = centre + translation + rotation * (p_now - centre).
struct RigidMotion {
  Eigen::Vector3f translation = Eigen::Vector3f::Zero();  ///< of the centre [m]
  Eigen::Matrix3f rotation = Eigen::Matrix3f::Identity();
};

/// The surface of a thing in the frame now, with the camera's own motion removed.
struct ObjectPoints {
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();
  std::vector<Eigen::Vector3f> points;  ///< where they would be seen then if they had stood still: camera frame of then
  std::vector<float> grey;              ///< brightness of each
};

struct AlignmentResult {
  RigidMotion motion;
  Eigen::Matrix3f covariance = Eigen::Matrix3f::Zero();           ///< of the translation [m^2]
  Eigen::Matrix3f rotation_covariance = Eigen::Matrix3f::Zero();  ///< [rad^2]
  int inliers = 0;                                                ///< points whose depth agrees then
};

/// Finds the rigid motion that takes the points of a thing back to where an earlier view shows them: the joint energy
/// of Co-Fusion (Ruenz and Agapito 2017, section on tracking: for each model the least E_icp + lambda E_rgb, squared
/// distances from points to the planes, and squared differences of brightness to the pixels, that they project to), by
/// Gauss and Newton, with Cauchy weights, since things bend. Distances are taken along the ray and weighed by the noise
/// of depth.
class RigidAlignment {
 public:
  /// What is expected of the motion; it decides where the surface does not.
  struct Prior {
    Eigen::Vector3f translation = Eigen::Vector3f::Zero();
    Eigen::Vector3f deviation = Eigen::Vector3f::Ones();  ///< by axis of the camera [m]
    float rotation_deviation = 0.1F;                      ///< about no rotation [rad]
  };

  RigidAlignment(const BlockGrid& grid, const DepthNoise& noise) : grid_(grid), noise_(noise) {}

  /// `owner` names a thing for every block of `then`; only the surface of the thing `name` counts. The descent begins
  /// at `start`. The result is the prior where nothing is seen.
  AlignmentResult align(const ObjectPoints& now, const DepthView& then, const std::vector<std::uint32_t>& owner,
                        std::uint32_t name, const RigidMotion& start, const Prior& prior) const;

 private:
  const BlockGrid& grid_;
  DepthNoise noise_;
};

}  // namespace holdfast::object_plugin
