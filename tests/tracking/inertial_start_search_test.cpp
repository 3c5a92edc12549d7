// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/inertial_start_search.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/inertial_motion.hpp"
#include "holdfast/core/random.hpp"

namespace holdfast {
namespace {

using Eigen::Vector3d;
using geometry::inertial_motion::gravity;
using geometry::inertial_motion::true_samples;
using geometry::inertial_motion::true_state;

/// A body whose camera has its frame, with poses that err by `deviation` [m] and half as much [rad].
struct StartBench {
  explicit StartBench(double deviation) : deviation(deviation) {
    imu.gyroscope_range = imu.accelerometer_range = 1000.0;
    samples = true_samples(-0.015, 15.0, imu.rate);
    for (ImuSample& sample : samples) {
      sample.angular_velocity += bias.gyroscope + normal(imu.noise.gyroscope_noise_density * std::sqrt(imu.rate));
      sample.acceleration += bias.accelerometer + normal(imu.noise.accelerometer_noise_density * std::sqrt(imu.rate));
    }
  }
  Vector3d normal(double size) {
    const double x = random.normal(), y = random.normal(), z = random.normal();
    return size * Vector3d(x, y, z);
  }
  Trajectory poses(int count, double interval, double unit = 1.0) {
    Trajectory result;
    for (int i = 0; i < count; ++i) {
      TimedPose pose{i * interval, true_state(i * interval).T_world_body};
      pose.T_world_camera.translation() += normal(deviation);
      pose.T_world_camera.translation() /= unit;
      pose.T_world_camera.linear() *= geometry::exp_so3(normal(0.5 * deviation)).toRotationMatrix();
      result.push_back(pose);
    }
    return result;
  }

  double deviation;
  ImuCalibration imu;
  ImuBias bias{{0.02, -0.01, 0.08}, {0.1, -0.15, 0.05}};
  Random random{1};
  std::vector<ImuSample> samples;
};

/// Between poses 2 s apart, motions do not depend linearly on a bias as large as that of EuRoC's gyroscope.
TEST(InertialStartSearch, PosesSecondsApartWithALargeBias) {
  StartBench bench(0.005);
  const InertialStartSearch search{.smallest_deviation = 0.005, .largest_deviation = 0.02};
  const auto found = find_inertial_start(bench.poses(7, 2.0), bench.samples, bench.imu, search);
  ASSERT_TRUE(found);
  EXPECT_LT((found->start.bias.gyroscope - bench.bias.gyroscope).norm(), 0.006);
  EXPECT_LT((found->start.gravity - gravity).norm(), 0.1);
  for (std::size_t i = 0; i < found->poses.size(); ++i)
    EXPECT_LT((found->start.velocities[i] - true_state(found->poses[i].timestamp).velocity).norm(), 0.1) << i;
  for (const geometry::Preintegration& motion : found->motions)
    EXPECT_LT((motion.bias().gyroscope - bench.bias.gyroscope).norm(), 0.01);
}

TEST(InertialStartSearch, StatesDeviationsThatExplainThePoses) {
  for (const double deviation : {0.002, 0.004, 0.008}) {
    StartBench bench(deviation);
    const auto found = find_inertial_start(bench.poses(40, 0.1), bench.samples, bench.imu, {});
    ASSERT_TRUE(found) << deviation;
    EXPECT_GT(found->deviations.position, 0.6 * deviation);
    EXPECT_LT(found->deviations.position, 1.6 * deviation);
    EXPECT_DOUBLE_EQ(found->deviations.rotation, 0.5 * found->deviations.position);
  }
}

TEST(InertialStartSearch, PosesThatNoDeviationExplainsAreNoStart) {
  StartBench bench(0.1);
  EXPECT_FALSE(find_inertial_start(bench.poses(40, 0.1), bench.samples, bench.imu, {}));
}

TEST(InertialStartSearch, FindsTheScale) {
  StartBench bench(0.002);
  const InertialStartSearch search{.estimate_scale = true};
  const auto found = find_inertial_start(bench.poses(30, 0.2, 0.4), bench.samples, bench.imu, search);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->start.scale, 0.4, 0.004);
}

TEST(InertialStartSearch, MissingMeasurementsAreNoStart) {
  StartBench bench(0.002);
  const Trajectory poses = bench.poses(40, 0.1);
  EXPECT_FALSE(find_inertial_start(poses, {}, bench.imu, {}));
  std::erase_if(bench.samples, [](const ImuSample& sample) { return std::abs(sample.timestamp - 2.0) < 0.1; });
  EXPECT_FALSE(find_inertial_start(poses, bench.samples, bench.imu, {}));
}

}  // namespace
}  // namespace holdfast
