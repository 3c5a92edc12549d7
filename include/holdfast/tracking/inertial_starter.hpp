// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <vector>

#include "holdfast/tracking/inertial_start_search.hpp"

namespace holdfast {

/// Starts inertial estimation while tracking (find_inertial_start): from poses 0.1 s apart of the last 2 s, at least
/// ten, with unknown scale 0.2 s apart of 5 s. A slow camera, which takes fewer frames in this time, starts with its
/// last poses, at least six of the last 15 s. Deterministic. One thread.
class InertialStarter {
 public:
  InertialStarter(const ImuCalibration& imu, bool scale_is_known) : imu_(imu), scale_is_known_(scale_is_known) {}

  /// Begins a frame at a later time stamp [s].
  void begin_frame(double timestamp);
  /// Adds the measurements up to the current frame, without a gap.
  void add(const std::vector<ImuSample>& samples);

  /// Pose by the map as it is now of a frame that was tracked, empty if it has none any more.
  using PastPose = std::function<std::optional<Eigen::Isometry3d>(double timestamp)>;
  /// The current frame was tracked. Empty if that does not suffice for a start.
  std::optional<FoundInertialStart> found(const PastPose& past_pose);
  /// Forgets measurements and tracked frames.
  void clear();

 private:
  bool is_slow_camera() const;
  void forget_before(double earliest);

  const ImuCalibration imu_;
  const bool scale_is_known_;
  std::vector<ImuSample> samples_;
  std::vector<double> frames_;   // time stamps of all frames, tracked or not [s]
  std::vector<double> tracked_;  // [s]
  double next_start_ = 0.0;      // [s]
};

}  // namespace holdfast
