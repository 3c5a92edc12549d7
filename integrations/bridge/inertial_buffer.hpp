// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "holdfast/core/imu_sample.hpp"

namespace holdfast::bridge {

/// Inertial measurements until their frame comes. One thread at a time.
class InertialBuffer {
 public:
  /// A sample with a time stamp of the camera's clock; one that does not follow the last is dropped.
  void add(const ImuSample& sample) {
    if (!samples_.empty() && !(sample.timestamp > samples_.back().timestamp)) return;
    samples_.push_back(sample);
    // A minute at 1 kHz: nothing fetches them.
    constexpr std::size_t most = 60000;
    if (samples_.size() > most) samples_.pop_front();
  }
  /// Whether a sample at or after this time has come [s].
  bool reaches(double timestamp) const { return !samples_.empty() && samples_.back().timestamp >= timestamp; }
  /// The samples of a frame, as SensorFrame::imu specifies. Frames are passed in temporal order.
  std::vector<ImuSample> take(double timestamp) {
    const double from = last_.value_or(timestamp);
    while (samples_.size() > 1 && samples_[1].timestamp <= from) samples_.pop_front();
    std::vector<ImuSample> taken;
    for (const ImuSample& sample : samples_) {
      taken.push_back(sample);
      if (sample.timestamp >= timestamp) break;
    }
    last_ = timestamp;
    return taken;
  }
  void clear() { samples_.clear(), last_.reset(); }

 private:
  std::deque<ImuSample> samples_;
  std::optional<double> last_;  // time stamp of the last frame
};

}  // namespace holdfast::bridge
