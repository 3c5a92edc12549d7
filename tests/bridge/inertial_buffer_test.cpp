// SPDX-License-Identifier: BSD-3-Clause
#include "inertial_buffer.hpp"

#include <gtest/gtest.h>

#include "holdfast/core/imu_timeline.hpp"

namespace holdfast::bridge {
namespace {

/// The same samples of each frame as those of a recording that is known wholly.
TEST(InertialBuffer, GivesAFrameWhatARecordingWould) {
  std::vector<ImuSample> samples;
  for (int i = 0; i < 200; ++i) samples.push_back({0.005 * i, Eigen::Vector3d(i, 0, 0), Eigen::Vector3d::Zero()});
  ImuTimeline recorded(samples);
  InertialBuffer buffer;
  std::size_t next = 0;
  for (int frame = 0; frame < 25; ++frame) {
    const double timestamp = 0.02 + 0.0333 * frame;
    // Some come before their frame does.
    while (next < samples.size() && !buffer.reaches(timestamp + 0.02)) buffer.add(samples[next++]);
    EXPECT_EQ(buffer.take(timestamp), recorded.take(timestamp)) << frame;
  }
}

TEST(InertialBuffer, DropsSamplesThatGoBackInTime) {
  InertialBuffer buffer;
  buffer.add({1.0, {}, {}});
  buffer.add({1.5, {}, {}});
  buffer.add({0.5, {}, {}});
  buffer.add({1.5, {}, {}});
  EXPECT_TRUE(buffer.reaches(1.5));
  EXPECT_EQ(buffer.take(1.0).size(), 1U);
  EXPECT_EQ(buffer.take(1.5).size(), 2U);
}

}  // namespace
}  // namespace holdfast::bridge
