// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>

#include "holdfast/core/build_layout.hpp"

namespace holdfast {

/// A rigid object that moves or has moved, as tracked over frames. World frame, metres.
///
/// The origin is the centroid of the visible surface, smoothed over time. For an object seen from one side only, this
/// is not the centroid of the object. A non-rigid object such as a person is approximated by one rigid motion.
struct MovingObject {
  std::uint32_t id = 0;  ///< from 1; never reused
  /// Id of its instance in the mask (CellMask::instances), constant while the object is visible; 0 without instances.
  std::uint16_t instance = 0;
  std::string class_name;  ///< majority of the mask's labels on the object; empty without a majority
  /// Pose of the object. Its axes are parallel to the world axes when the object is first seen and rotate with it.
  Eigen::Isometry3d T_world_object = Eigen::Isometry3d::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          ///< of the origin, world frame [m/s]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< world frame [rad/s]
  Eigen::AlignedBox3f box;       ///< bounding box of the visible surface, object frame [m]
  float speed_deviation = 0.0F;  ///< standard deviation of the speed [m/s]
  bool moving = false;           ///< whether it moves now; otherwise it is at rest after a motion
  double first_seen = 0.0;       ///< [s]
  /// Time of the last observation [s]. While the object is occluded it is in the past, and the pose is a prediction.
  double last_seen = 0.0;

  double speed() const;
};

}  // namespace holdfast
