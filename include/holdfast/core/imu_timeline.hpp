// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "holdfast/core/imu.hpp"
#include "holdfast/core/imu_sample.hpp"

namespace holdfast {

/// Appends the samples of a later frame without those that `samples` already contains, as if both frames were one.
void append_imu(std::vector<ImuSample>& samples, const std::vector<ImuSample>& later);

/// Returns the samples, the first and the last one repeated at the ends of the interval [s] where they miss these by at
/// most two sampling intervals: those beyond the first and the latest frame of a recording may be missing.
std::vector<ImuSample> covering(std::vector<ImuSample> samples, double begin, double end, const ImuCalibration& imu);

/// Whether any measurement is at the end of the sensor's range: it says nothing of the motion.
bool has_saturated(std::span<const ImuSample> samples, const ImuCalibration& imu);

/// Splits the inertial measurements of a recording by frame, as SensorFrame::imu specifies. Used by one thread.
class ImuTimeline {
 public:
  ImuTimeline() = default;
  /// `samples`: strictly increasing time stamps of the IMU's clock. `time_offset`: see ImuCalibration.
  explicit ImuTimeline(std::vector<ImuSample> samples, double time_offset = 0.0);

  bool empty() const { return samples_.empty(); }
  /// All samples, with time stamps of the camera's clock.
  const std::vector<ImuSample>& samples() const { return samples_; }
  /// Returns the samples of the frame at `timestamp` [s]. Frames must be passed in temporal order.
  std::vector<ImuSample> take(double timestamp);

 private:
  std::vector<ImuSample> samples_;
  std::optional<double> last_;  ///< the time stamp of the last frame
};

}  // namespace holdfast
