// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/core/map.hpp"

namespace holdfast::test {

/// No two numbers are alike, except those of rotations.
inline MapInertia example_inertia() {
  MapInertia inertia;
  inertia.gravity << 1.5, -9.5, 0.75;
  inertia.scale = 0.375;
  inertia.bias.gyroscope << 0.01, -0.02, 0.03;
  inertia.bias.accelerometer << 0.1, 0.2, -0.3;
  inertia.mounting = Eigen::AngleAxisd(0.02, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  inertia.time_offset = 0.004;
  inertia.gravity_deviation = 0.005;
  inertia.gyroscope_deviation = 0.006;
  inertia.accelerometer_deviation = 0.007;
  inertia.mounting_deviation = 0.008;
  inertia.time_offset_deviation = 0.009;
  inertia.position_deviation = 0.011;
  inertia.rotation_deviation = 0.012;
  inertia.T_body_camera =
      Eigen::Translation3d(0.13, -0.14, 0.15) * Eigen::AngleAxisd(1.6, Eigen::Vector3d(3, 2, 1).normalized());
  inertia.calibrated_time_offset = -0.016;
  return inertia;
}

inline bool are_same(const MapInertia& a, const MapInertia& b) {
  return a.gravity == b.gravity && a.scale == b.scale && a.bias.gyroscope == b.bias.gyroscope &&
         a.bias.accelerometer == b.bias.accelerometer && a.mounting == b.mounting && a.time_offset == b.time_offset &&
         a.gravity_deviation == b.gravity_deviation && a.gyroscope_deviation == b.gyroscope_deviation &&
         a.accelerometer_deviation == b.accelerometer_deviation && a.mounting_deviation == b.mounting_deviation &&
         a.time_offset_deviation == b.time_offset_deviation && a.position_deviation == b.position_deviation &&
         a.rotation_deviation == b.rotation_deviation && a.T_body_camera.matrix() == b.T_body_camera.matrix() &&
         a.calibrated_time_offset == b.calibrated_time_offset;
}

/// Some keyframes get a vertical, some a motion, some both, the first none.
inline void add_motions(Map& map) {
  int i = 0;
  for (const KeyFrameId id : map.keyframes_by_age()) {
    KeyFrame& keyframe = map.keyframe(id);
    if (i % 2 == 1) keyframe.vertical = Eigen::Vector3d(0.1 * i, 0.9, -0.2).normalized();
    if (i % 3 == 2)
      keyframe.motion = KeyFrameMotion{{0.1 * i, -0.2, 0.3}, {{0.01, 0.02 * i, 0.03}, {0.1, -0.2, 0.3 + i}}};
    ++i;
  }
}

}  // namespace holdfast::test
