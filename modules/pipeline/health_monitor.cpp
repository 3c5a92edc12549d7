// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/pipeline/health_monitor.hpp"

namespace holdfast {

void HealthMonitor::add(const FrameResult& result, double now) {
  constexpr double share_of_new = 0.1;
  const std::lock_guard lock(mutex_);
  double period = last_.frame_period;
  if (time_) period = period > 0.0 ? (1.0 - share_of_new) * period + share_of_new * (now - *time_) : now - *time_;
  last_ = {.health = result.health,
           .frame = result.index,
           .timestamp = result.timestamp,
           .T_world_camera = result.T_world_camera,
           .covariance = result.covariance,
           .frame_period = period};
  time_ = now;
}

void HealthMonitor::finish() {
  const std::lock_guard lock(mutex_);
  is_finished_ = true;
}

PipelineHealth HealthMonitor::health(double now, double patience) const {
  const std::lock_guard lock(mutex_);
  PipelineHealth health = last_;
  if (!time_) return health;
  health.since_frame = now - *time_;
  if (!is_finished_ && health.frame_period > 0.0 && health.since_frame > patience * health.frame_period)
    health.health.state = HealthState::stalled;
  return health;
}

}  // namespace holdfast
