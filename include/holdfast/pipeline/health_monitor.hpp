// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mutex>
#include <optional>

#include "holdfast/core/frame_health.hpp"
#include "holdfast/core/frame_result.hpp"

namespace holdfast {

/// Keeps the health of the last frame for other threads, and notices a sensor that has stalled. Times are seconds of
/// any steady clock. Any thread.
class HealthMonitor {
 public:
  /// The result of a frame that was processed at this time.
  void add(const FrameResult& result, double now);
  /// No more frames come: health() does not report a stall any more.
  void finish();
  /// Health at this time. The state is stalled if no frame came for more than `patience` periods; a period is the
  /// exponential average of the time between results.
  PipelineHealth health(double now, double patience) const;

 private:
  mutable std::mutex mutex_;
  PipelineHealth last_;
  std::optional<double> time_;  // of the last frame
  bool is_finished_ = false;
};

}  // namespace holdfast
