// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/geometry/inertial_start.hpp"

#include <gtest/gtest.h>

#include "geometry/inertial_motion.hpp"
#include "holdfast/core/median.hpp"
#include "holdfast/core/random.hpp"

namespace holdfast::geometry {
namespace {

using inertial_motion::gravity;

constexpr double degree = EIGEN_PI / 180.0;

Eigen::Vector3d normal(Random& random, double deviation) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return deviation * Eigen::Vector3d(x, y, z);
}

/// What images and an IMU with biases give of a motion, in a world that is turned.
struct StartCase {
  ImuBias bias{{0.02, -0.01, 0.03}, {0.1, -0.15, 0.05}};
  Eigen::Matrix3d R_map_world = exp_so3({0.7, -1.1, 0.4}).toRotationMatrix();
  Eigen::Isometry3d T_body_camera = Eigen::Isometry3d::Identity();
  std::vector<Eigen::Isometry3d> poses;
  std::vector<Preintegration> motions;
  std::vector<InertialState> truth;
  std::vector<Eigen::Vector3d> rates;

  /// `rest`: the body stands as at time 0; `unit`: metres in a unit of the poses; `time_offset`: the poses are later
  /// than the motions.
  StartCase(double seconds, double interval, std::uint64_t seed, bool rest = false, double unit = 1.0,
            double time_offset = 0.0) {
    Random random(seed);
    const ImuNoise noise{2e-4, 2e-3, 2e-5, 1e-3};
    T_body_camera.linear() = exp_so3({-1.2, 0.3, 0.9}).toRotationMatrix();
    T_body_camera.translation() << 0.1, -0.05, 0.03;
    std::vector<ImuSample> samples =
        inertial_motion::true_samples(time_offset > 0.0 ? -0.02 : 0.0, seconds + 0.02, 200.0);
    if (rest)
      for (ImuSample& sample : samples) {
        sample.angular_velocity.setZero();
        sample.acceleration = -inertial_motion::true_state(0.0).T_world_body.linear().transpose() * gravity;
      }
    for (ImuSample& sample : samples) {
      sample.angular_velocity += bias.gyroscope + normal(random, noise.gyroscope_noise_density * std::sqrt(200.0));
      sample.acceleration += bias.accelerometer + normal(random, noise.accelerometer_noise_density * std::sqrt(200.0));
    }
    const int count = static_cast<int>(std::lround(seconds / interval));
    for (int i = 0; i <= count; ++i) {
      InertialState state = inertial_motion::true_state(rest ? 0.0 : i * interval);
      if (rest) state.velocity.setZero();
      Eigen::Isometry3d camera = state.T_world_body * T_body_camera;
      camera.translation() += normal(random, 0.001);
      camera.linear() = camera.linear() * exp_so3(normal(random, 0.0005)).toRotationMatrix();
      camera.linear() = R_map_world * camera.linear();
      camera.translation() = R_map_world * camera.translation() / unit + Eigen::Vector3d(3, 4, 5);
      poses.push_back(camera);
      truth.push_back(state);
      const double stamp = i * interval - time_offset;
      const auto next = std::find_if(samples.begin(), samples.end(),
                                     [stamp](const ImuSample& sample) { return sample.timestamp >= stamp; });
      rates.push_back(next->angular_velocity);
      if (i > 0) motions.push_back(*preintegrate(samples, stamp - interval, stamp, noise, {}));
    }
  }

  InertialStart start(InertialStartOptions options = {}) const {
    return start_inertially(poses, motions, T_body_camera, options, rates);
  }
  double gravity_error(const InertialStart& start) const {
    const Eigen::Vector3d down = R_map_world * gravity;
    return std::atan2(down.cross(start.gravity).norm(), down.dot(start.gravity));
  }
  double velocity_error(const InertialStart& start) const {
    double largest = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i)
      largest = std::max(largest, (start.velocities[i] - R_map_world * truth[i].velocity).norm());
    return largest;
  }
};

InertialStartOptions with_scale() {
  InertialStartOptions options;
  options.estimate_scale = true;
  return options;
}

TEST(InertialStart, TwoSecondsOfMotionServeWhereTheUnitIsKnown) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const StartCase given(2.0, 0.1, seed);
    const InertialStart start = given.start();
    ASSERT_TRUE(start.usable) << seed << " " << start.mean_chi_square << " " << start.direction_deviation;
    EXPECT_LT(given.gravity_error(start), 0.5 * degree);
    EXPECT_LT(given.gravity_error(start), 4.0 * start.direction_deviation);
    EXPECT_NEAR(start.gravity.norm(), standard_gravity, 1e-9);
    EXPECT_LT((start.bias.gyroscope - given.bias.gyroscope).norm(), 2e-3);
    EXPECT_LT((start.bias.accelerometer - given.bias.accelerometer).norm(),
              4.0 * std::sqrt(3.0) * start.accelerometer_bias_deviation);
    EXPECT_LT((start.bias.accelerometer - given.bias.accelerometer).norm(), 0.1);
    EXPECT_LT(given.velocity_error(start), 0.03);
    EXPECT_EQ(start.scale, 1.0);
  }
}

TEST(InertialStart, CorrectsTheCalibration) {
  const Eigen::Matrix3d mounting = exp_so3({0.015, -0.02, 0.01}).toRotationMatrix();
  InertialStartOptions options;
  options.mounting_deviation = 0.015;
  options.time_offset_deviation = 0.005;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    StartCase given(3.0, 0.1, seed, false, 1.0, 0.006);
    given.T_body_camera = mounting * given.T_body_camera;
    const InertialStart start = given.start(options);
    EXPECT_TRUE(start.usable) << start.mean_chi_square;
    EXPECT_LT(log_so3(Eigen::Matrix3d(mounting.transpose() * start.mounting)).norm(), 0.003);
    EXPECT_NEAR(start.time_offset, 0.006, 0.0007);
    EXPECT_LT(given.gravity_error(start), 0.5 * degree);
    EXPECT_LT(start.mean_chi_square, 0.5 * given.start().mean_chi_square)
        << "with a calibration that is taken as exact";
  }
}

TEST(InertialStart, AtRestGravityIsKnownUpToTheBias) {
  const StartCase given(2.0, 0.1, 3, true);
  const InertialStart start = given.start();
  EXPECT_TRUE(start.usable);
  EXPECT_LT(given.gravity_error(start), 2.0 * degree);
  EXPECT_GT(start.direction_deviation, 0.01) << "the bias could be a part of gravity";
  EXPECT_LT((start.bias.gyroscope - given.bias.gyroscope).norm(), 2e-3);
  EXPECT_LT(given.velocity_error(start), 0.03);
}

TEST(InertialStart, FiveSecondsOfMotionGiveTheScale) {
  for (const double unit : {0.3, 1.0, 7.0}) {
    const StartCase given(5.0, 0.2, 4, false, unit);
    const InertialStart start = given.start(with_scale());
    ASSERT_TRUE(start.usable) << start.mean_chi_square << " " << start.scale_deviation;
    EXPECT_NEAR(start.scale / unit, 1.0, 0.01);
    EXPECT_LT(std::abs(start.scale / unit - 1.0), 4.0 * start.scale_deviation);
    EXPECT_LT(given.gravity_error(start), 0.5 * degree);
    EXPECT_LT(given.velocity_error(start), 0.03);
  }
}

TEST(InertialStart, AtRestThereIsNoScale) {
  const StartCase given(5.0, 0.2, 5, true);
  const InertialStart start = given.start(with_scale());
  EXPECT_FALSE(start.usable);
}

TEST(InertialStart, IsRefutedByPosesOfAnotherMotion) {
  StartCase given(2.0, 0.1, 6);
  EXPECT_TRUE(given.start().usable);
  StartCase turned = given;
  turned.T_body_camera.linear() = exp_so3({0.5, 0, 0}).toRotationMatrix() * turned.T_body_camera.linear();
  EXPECT_FALSE(turned.start().usable) << "the extrinsic rotation is wrong";
  EXPECT_GT(turned.start().mean_chi_square, 10.0);
  for (std::size_t i = 10; i < given.poses.size(); ++i) given.poses[i].translation().x() += 0.3;
  EXPECT_FALSE(given.start().usable) << "a jump of the visual poses";
}

TEST(InertialStart, NeedsFourPosesWithAMotionBetweenEachTwo) {
  const StartCase given(2.0, 0.1, 7);
  const std::span<const Eigen::Isometry3d> poses = given.poses;
  const std::span<const Preintegration> motions = given.motions;
  EXPECT_FALSE(start_inertially(poses.first(3), motions.first(2), given.T_body_camera).usable);
  EXPECT_FALSE(start_inertially(poses.first(10), motions.first(10), given.T_body_camera).usable);
  EXPECT_FALSE(start_inertially({}, {}, given.T_body_camera).usable);
}

/// EuRoC V1_01_easy, whose true orientations are tilted by some 2 degrees: 3 s of true poses, 5 s for the scale.
TEST(InertialStartData, StartsInARealFlight) {
  const std::optional<std::filesystem::path> folder = inertial_motion::flight_folder();
  if (!folder) GTEST_SKIP() << "HOLDFAST_DATA does not name the folder with euroc_v101_imu";
  const inertial_motion::RecordedFlight flight = inertial_motion::read_flight(*folder);
  const ImuNoise noise{1.6968e-04, 2.0e-03, 1.9393e-05, 3.0e-03};
  for (const bool estimate_scale : {false, true}) {
    InertialStartOptions options;
    options.estimate_scale = estimate_scale;
    options.rotation_deviation = 0.003;
    std::vector<double> tilt, rate, velocity, scale;
    int windows = 0;
    const std::size_t stride = estimate_scale ? 4 : 2, length = (estimate_scale ? 100 : 60) / stride;
    for (std::size_t begin = 100; begin + stride * length + 1 < flight.body.size(); begin += 50) {
      std::vector<Eigen::Isometry3d> poses;
      std::vector<Preintegration> motions;
      for (std::size_t i = 0; i <= length; ++i) {
        const TimedPose& pose = flight.body[begin + i * stride];
        poses.push_back(pose.T_world_camera * flight.T_body_camera);
        if (i == 0) continue;
        const auto motion =
            preintegrate(flight.samples, flight.body[begin + (i - 1) * stride].timestamp, pose.timestamp, noise, {});
        ASSERT_TRUE(motion);
        motions.push_back(*motion);
      }
      ++windows;
      const InertialStart start = start_inertially(poses, motions, flight.T_body_camera, options);
      if (!start.usable) continue;
      const std::size_t middle = begin + length / 2 * stride;
      const Eigen::Vector3d moved =
          flight.body[middle + 1].T_world_camera.translation() - flight.body[middle - 1].T_world_camera.translation();
      const double seconds = flight.body[middle + 1].timestamp - flight.body[middle - 1].timestamp;
      tilt.push_back(std::acos(-start.gravity.normalized().z()) / degree);
      rate.push_back((start.bias.gyroscope - Eigen::Vector3d(-0.0023, 0.0249, 0.0817)).norm());
      velocity.push_back((start.velocities[length / 2] - moved / seconds).norm());
      scale.push_back(std::abs(start.scale - 1.0));
    }
    EXPECT_LT(upper_median(tilt), 3.0);
    EXPECT_LT(upper_median(rate), 0.01);
    EXPECT_LT(upper_median(velocity), 0.03);
    EXPECT_LT(upper_median(scale), 0.03);
  }
}

}  // namespace
}  // namespace holdfast::geometry
