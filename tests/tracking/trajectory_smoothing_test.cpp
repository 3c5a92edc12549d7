// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/trajectory_smoothing.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "holdfast/core/random.hpp"
#include "holdfast/geometry/so3.hpp"

namespace holdfast {
namespace {

/// A camera on a hand that turns by more than a whole turn, with errors of 4 mm and 4 mrad.
struct Recording {
  Trajectory truth, measured;

  Recording() {
    Random random(7);
    const auto noise = [&]() -> Eigen::Vector3d {
      return 0.004 * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
    };
    for (int i = 0; i < 240; ++i) {
      TimedPose pose;
      pose.timestamp = i / 30.0;
      const double time = pose.timestamp;
      pose.T_world_camera = geometry::exp_so3({0.4 * std::sin(time), 1.1 * time, 0.3 * std::cos(time)});
      pose.T_world_camera.translation() = Eigen::Vector3d(std::sin(time), 0.2 * time, std::cos(0.5 * time));
      truth.push_back(pose);
      pose.T_world_camera.translation() += noise();
      pose.T_world_camera.linear() = geometry::exp_so3(noise()) * pose.T_world_camera.linear();
      measured.push_back(pose);
    }
  }
  /// Errors of position [m] and rotation [rad].
  Eigen::Vector2d error(const Trajectory& trajectory) const {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const Eigen::Isometry3d difference = trajectory[i].T_world_camera.inverse() * truth[i].T_world_camera;
      sum += Eigen::Vector2d(difference.translation().squaredNorm(),
                             geometry::log_so3(Eigen::Matrix3d(difference.linear())).squaredNorm());
    }
    return (sum / static_cast<double>(truth.size())).cwiseSqrt();
  }
};

TEST(TrajectorySmoothing, LessensErrorsOfPositionAndRotation) {
  const Recording recording;
  const Trajectory smoothed = smooth_trajectory(recording.measured);
  const Eigen::Vector2d before = recording.error(recording.measured), after = recording.error(smoothed);
  EXPECT_LT(after[0], 0.6 * before[0]);
  EXPECT_LT(after[1], 0.6 * before[1]);
  for (const TimedPose& pose : smoothed)
    EXPECT_NEAR(
        (pose.T_world_camera.linear() * pose.T_world_camera.linear().transpose() - Eigen::Matrix3d::Identity()).norm(),
        0.0, 1e-12);
}

TEST(TrajectorySmoothing, ReplacesThePosesOfTheHistoryAndNotThoseOfTheMap) {
  const Recording recording;
  Map map;
  FrameHistory history;
  Frame keyframe;
  keyframe.camera = std::make_shared<Camera>(find_camera("tum_fr3").value());
  KeyFrameId reference;
  for (std::size_t i = 0; i < recording.measured.size(); ++i) {
    Frame frame = keyframe;
    frame.timestamp = recording.measured[i].timestamp;
    frame.T_camera_world = recording.measured[i].T_world_camera.inverse();
    if (i % 60 == 0) reference = map.add_keyframe(frame);
    history.add(frame, reference, map);
    if (i % 60 == 0) history.became_keyframe(reference, frame.timestamp);
  }
  const Eigen::Isometry3d of_keyframe = map.keyframe(reference).frame.T_camera_world;
  smooth_trajectory(history, map);
  const Trajectory smoothed = smooth_trajectory(recording.measured), replaced = history.trajectory(map);
  ASSERT_EQ(replaced.size(), smoothed.size());
  for (std::size_t i = 0; i < replaced.size(); ++i)
    EXPECT_TRUE(replaced[i].T_world_camera.isApprox(smoothed[i].T_world_camera, 1e-9)) << i;
  EXPECT_EQ(map.keyframe(reference).frame.T_camera_world.matrix(), of_keyframe.matrix());
}

}  // namespace
}  // namespace holdfast
