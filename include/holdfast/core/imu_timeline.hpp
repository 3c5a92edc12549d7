// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "holdfast/core/imu_sample.hpp"

namespace holdfast {

/// Appends those of a later frame's samples that are later than `samples`, so that both frames' samples are those of
/// one.
void append_imu(std::vector<ImuSample>& samples, const std::vector<ImuSample>& later);

/// Deals the inertial measurements of a recording to its frames, as SensorFrame::imu describes. Used by one thread.
class ImuTimeline {
 public:
  ImuTimeline() = default;
  /// Samples by the clock of the IMU, whose time stamps increase strictly; `time_offset` is that of ImuCalibration.
  explicit ImuTimeline(std::vector<ImuSample> samples, double time_offset = 0.0);

  bool empty() const { return samples_.empty(); }
  /// All samples, by the clock of the camera.
  const std::vector<ImuSample>& samples() const { return samples_; }
  /// Returns the samples for the frame at `timestamp` [s], which follows that of the last call.
  std::vector<ImuSample> take(double timestamp);

 private:
  std::vector<ImuSample> samples_;
  std::optional<double> last_;  ///< the time stamp of the last frame
};

}  // namespace holdfast
