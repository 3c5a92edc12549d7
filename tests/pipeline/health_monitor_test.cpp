// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/pipeline/health_monitor.hpp"

#include <gtest/gtest.h>

namespace holdfast {
namespace {

TEST(HealthMonitor, NoticesASensorThatStalls) {
  HealthMonitor monitor;
  EXPECT_EQ(monitor.health(100.0, 10.0).health.state, HealthState::waiting) << "no frame yet";
  FrameResult result;
  result.health.state = HealthState::good;
  for (int i = 0; i < 20; ++i) {
    result.index = static_cast<std::uint64_t>(i);
    monitor.add(result, 0.1 * i);
  }
  const PipelineHealth soon = monitor.health(2.5, 10.0);
  EXPECT_EQ(soon.health.state, HealthState::good);
  EXPECT_EQ(soon.frame, 19U);
  EXPECT_NEAR(soon.frame_period, 0.1, 1e-9);
  EXPECT_NEAR(soon.since_frame, 0.6, 1e-9);
  EXPECT_EQ(monitor.health(3.0, 10.0).health.state, HealthState::stalled);
  EXPECT_EQ(monitor.health(3.0, 20.0).health.state, HealthState::good);
  monitor.add(result, 3.0);
  EXPECT_EQ(monitor.health(3.1, 10.0).health.state, HealthState::good);
  monitor.finish();
  EXPECT_EQ(monitor.health(99.0, 10.0).health.state, HealthState::good);
}

}  // namespace
}  // namespace holdfast
