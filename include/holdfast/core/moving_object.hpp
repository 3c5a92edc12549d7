// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>

namespace holdfast {

/// A thing that moves, or has moved, as tracked over frames. World frame and metres as everywhere.
///
/// Its origin is the middle of the surface that the camera sees, smoothed over time; of a thing that is seen from one
/// side only that is not the middle of the thing. Something that bends, like a person, moves as its body as a whole.
struct MovingObject {
  std::uint32_t id = 0;    ///< from 1, never used again
  std::string class_name;  ///< by the majority of the mask's labels on it; empty when they do not tell
  /// Axes: those of the world when it was first seen, turned with it since.
  Eigen::Isometry3d T_world_object = Eigen::Isometry3d::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          ///< of the origin, in the world [m/s]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< about the world's axes [rad/s]
  Eigen::AlignedBox3f box;                                     ///< that holds its visible surface, object frame [m]
  float speed_deviation = 0.0F;                                ///< standard deviation of the speed [m/s]
  bool moving = false;                                         ///< now; else it stands, and has moved before
  double first_seen = 0.0;                                     ///< [s]
  /// [s]; earlier than the frame's stamp while it is hidden, and its pose then only predicted.
  double last_seen = 0.0;

  double speed() const { return velocity.norm(); }
};

}  // namespace holdfast
