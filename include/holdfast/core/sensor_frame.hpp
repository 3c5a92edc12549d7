// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "holdfast/core/build_layout.hpp"
#include "holdfast/core/imu.hpp"

namespace holdfast {

/// Ground truth of one frame, as far as the source has it; used by exact segmenters, evaluation and tests.
struct FrameTruth {
  std::optional<Eigen::Isometry3d> T_world_camera;
  cv::Mat object_mask;   ///< 8UC1, 0 = static world, k = object k; empty when unknown
  cv::Mat class_labels;  ///< 8UC1, index into the source's class names; empty when unknown
  /// Indices in object_mask of the objects that move at this time, in increasing order; the other objects are movable
  /// but at rest.
  std::vector<std::uint8_t> moving_objects;
};

/// Maximum valid depth [m]: beyond the range of any sensor, and within that of map files (1e9 m from the origin).
constexpr float largest_measured_depth = 1e6F;

/// Whether a pixel of a depth image holds a valid measurement: a positive number up to the maximum depth.
inline bool is_measured_depth(float depth) { return depth > 0.0F && depth <= largest_measured_depth; }

/// Images of a camera or of a stereo pair at one time. The images are shared, not copied, and must not be written to.
struct SensorFrame {
  std::uint64_t index = 0;  ///< number of the frame in its source, from 0; skipped frames are counted
  double timestamp = 0.0;   ///< time stamp of the colour image [s]
  /// Time from the exposure of the colour image to that of the depth image [s]: negative if depth came first, 0 if the
  /// sensor exposes both together or the source does not know.
  double depth_delay = 0.0;
  cv::Mat colour;  ///< 8UC3, blue green red; Pipeline::feed() takes grey images, 8UC1, as well
  cv::Mat depth;   ///< 32FC1 along the optical axis [m], 0 = no value; same size as colour; may be empty
  /// Right image of a rectified stereo pair (8UC1 or 8UC3), of which `colour` is the left image. A point lies in the
  /// same row of both, and Camera::baseline * fx / depth columns further left in the right image. Same size as colour;
  /// may be empty.
  cv::Mat right;
  std::shared_ptr<const FrameTruth> truth;  ///< nullptr if the source has none
  /// Inertial measurements between the previous frame and this one, in temporal order, with time stamps of the camera's
  /// clock. The interval is extended to the last measurement at or before the previous frame and to the first one at or
  /// after this frame, if they exist. For the first frame of a source it begins at the last measurement at or before
  /// the frame. Empty without an IMU.
  std::vector<ImuSample> imu;
};

}  // namespace holdfast
