// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/inertial_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "geometry/inertial_motion.hpp"
#include "holdfast/core/imu_timeline.hpp"
#include "holdfast/core/random.hpp"

namespace holdfast {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using geometry::exp_so3;
using geometry::InertialState;
using geometry::inertial_motion::gravity;
using geometry::inertial_motion::true_samples;
using geometry::inertial_motion::true_state;

Vector3d normal(Random& random, double deviation) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return deviation * Vector3d(x, y, z);
}

/// A camera with an IMU whose images give poses with noise, in a map whose world is turned and in another unit.
struct InertialBench {
  /// `rest`: the body stands as at time 0; `unit`: metres in a unit of the map.
  explicit InertialBench(double seconds, bool rest = false, double unit = 1.0, std::uint64_t seed = 1)
      : random(seed), at_rest(rest), unit(unit), motion(calibration(), unit == 1.0) {
    T_map_world.linear() = exp_so3({0.7, -1.1, 0.4}).toRotationMatrix();
    T_map_world.translation() << 3, 4, 5;
    samples = true_samples(-0.015, seconds + 0.02, rate);
    for (ImuSample& sample : samples) {
      if (rest) {
        sample.angular_velocity.setZero();
        sample.acceleration = -true_state(0.0).T_world_body.linear().transpose() * gravity;
      }
      sample.angular_velocity += bias.gyroscope + normal(random, noise.gyroscope_noise_density * std::sqrt(rate));
      sample.acceleration += bias.accelerometer + normal(random, noise.accelerometer_noise_density * std::sqrt(rate));
    }
  }

  static ImuCalibration calibration() {
    ImuCalibration imu;
    imu.rate = rate;
    imu.noise = noise;
    imu.gyroscope_range = imu.accelerometer_range = 1000.0;
    imu.T_body_camera.linear() = exp_so3({-1.2, 0.3, 0.9}).toRotationMatrix();
    imu.T_body_camera.translation() << 0.1, -0.05, 0.03;
    return imu;
  }

  InertialState state(double time) const {
    InertialState state = true_state(at_rest ? 0.0 : time);
    if (at_rest) state.velocity.setZero();
    return state;
  }
  /// T_camera_world of the map.
  Isometry3d pose(double time) const {
    Isometry3d T_map_camera = T_map_world * state(time).T_world_body * calibration().T_body_camera;
    T_map_camera.translation() /= unit;
    return T_map_camera.inverse();
  }
  Isometry3d measured(double time) {
    Isometry3d T_map_camera = pose(time).inverse();
    T_map_camera.translation() += normal(random, 0.002 / unit);
    T_map_camera.linear() = T_map_camera.linear() * exp_so3(normal(random, 0.001)).toRotationMatrix();
    return T_map_camera.inverse();
  }

  /// Begins the frame at the next time.
  void begin() {
    time = frames++ / frame_rate;
    if (!timeline) timeline.emplace(samples);
    SensorFrame frame;
    frame.timestamp = time;
    frame.imu = timeline->take(time);
    if (change) change(frame.imu);
    motion.begin_frame(frame);
    if (last) motion.follow_map(*last);
  }
  void found(const Isometry3d& T_camera_world) {
    poses[time] = T_camera_world;
    motion.found(T_camera_world, 0.0, [this](double stamp) { return std::optional(poses.at(stamp)); });
    last = T_camera_world;
  }
  /// Frames up to a time [s] that the images determine.
  void track(double until) {
    while (frames / frame_rate < until - 1e-9) {
      begin();
      found(measured(time));
    }
  }
  /// Frames up to a time that only inertia determines.
  void bridge(double until) {
    while (frames / frame_rate < until - 1e-9) {
      begin();
      ASSERT_TRUE(motion.prediction());
      last = motion.prediction()->T_camera_world;
      motion.bridged(*last);
    }
  }
  /// Error of the prediction for the current frame: distance, in the unit of the map.
  double distance() const {
    return (motion.prediction()->T_camera_world.inverse().translation() - pose(time).inverse().translation()).norm();
  }

  static constexpr double rate = 200.0;
  static constexpr ImuNoise noise{2e-4, 2e-3, 2e-5, 1e-3};
  const ImuBias bias{{0.02, -0.01, 0.03}, {0.1, -0.15, 0.05}};
  Isometry3d T_map_world = Isometry3d::Identity();
  Random random;
  bool at_rest;
  double unit;
  double frame_rate = 30.0;  // [Hz]
  std::vector<ImuSample> samples;
  std::function<void(std::vector<ImuSample>&)> change;
  std::optional<ImuTimeline> timeline;
  std::map<double, Isometry3d> poses;
  std::optional<Isometry3d> last;
  InertialMotion motion;
  int frames = 0;
  double time = 0.0;
};

TEST(InertialMotion, KnowsTheTurnOfTheCameraAtEachFrame) {
  InertialBench bench(4.0, false);
  bench.track(1.5);
  EXPECT_FALSE(bench.motion.turn_rate());
  bench.track(3.5);
  bench.begin();
  ASSERT_TRUE(bench.motion.turn_rate());
  constexpr double step = 1e-4;  // s
  const Eigen::Matrix3d before = bench.pose(bench.time - step).linear(), after = bench.pose(bench.time + step).linear();
  const Eigen::Vector3d rate = geometry::log_so3(Eigen::Matrix3d(before * after.transpose())) / (2.0 * step);
  EXPECT_GT(rate.norm(), 0.1);
  EXPECT_LT((*bench.motion.turn_rate() - rate).norm(), 0.02);
}

TEST(InertialMotion, StartsInMotionAndAtRest) {
  for (const bool rest : {false, true}) {
    InertialBench bench(3.0, rest);
    bench.track(1.9);
    EXPECT_FALSE(bench.motion.is_started());
    bench.track(2.3);
    EXPECT_TRUE(bench.motion.is_started());
    bench.track(3.0);
    ASSERT_TRUE(bench.motion.is_reliable());
    const InertialFilter& filter = *bench.motion.filter();
    EXPECT_LT((filter.state().bias.gyroscope - bench.bias.gyroscope).norm(), 0.002) << rest;
    EXPECT_LT((filter.state().velocity - bench.T_map_world.linear() * bench.state(bench.time).velocity).norm(), 0.02);
    const double angle = std::acos(filter.gravity().normalized().dot(bench.T_map_world.linear() * -Vector3d::UnitZ()));
    EXPECT_LT(angle, rest ? 0.03 : 0.01);  // at rest, the bias of the accelerometer looks like an inclination
  }
}

/// The bias is that of EuRoC's gyroscope: over a second, motions do not depend on it linearly.
TEST(InertialMotion, ASlowCameraStartsWithItsLastPoses) {
  InertialBench bench(12.1);
  bench.frame_rate = 1.0;
  const Vector3d more_bias(0.0, 0.0, 0.08);
  bench.change = [&](std::vector<ImuSample>& samples) {
    for (ImuSample& sample : samples) sample.angular_velocity += more_bias;
  };
  bench.track(5.0);
  EXPECT_FALSE(bench.motion.is_started()) << "five poses";
  bench.track(6.0);
  ASSERT_TRUE(bench.motion.is_started());
  bench.track(9.0);
  EXPECT_FALSE(bench.motion.is_reliable()) << "three predictions";
  bench.track(11.0);
  ASSERT_TRUE(bench.motion.is_reliable());
  const InertialFilter& filter = *bench.motion.filter();
  EXPECT_LT((filter.state().bias.gyroscope - bench.bias.gyroscope - more_bias).norm(), 0.002);
  EXPECT_LT((filter.state().velocity - bench.T_map_world.linear() * bench.state(bench.time).velocity).norm(), 0.05);
  bench.begin();
  EXPECT_LT(bench.distance(), 0.05);
  EXPECT_LT(bench.distance(), 3.0 * std::sqrt(3.0) * bench.motion.prediction()->position_deviation);
}

/// Ten poses of these rates span less than the two seconds that a start needs, eleven more than two seconds and a
/// tenth.
TEST(InertialMotion, StartsAtRatesThatDoNotDivideItsTime) {
  for (const double rate : {4.6, 5.2, 5.6}) {
    SCOPED_TRACE(rate);
    InertialBench bench(5.1);
    bench.frame_rate = rate;
    bench.track(4.0);
    EXPECT_TRUE(bench.motion.is_started());
  }
}

TEST(InertialMotion, FewPosesOfAFastCameraAreNoStart) {
  InertialBench bench(8.0);
  while (bench.frames < 210) {
    bench.begin();
    if (bench.frames % 30 == 0)
      bench.found(bench.measured(bench.time));
    else
      bench.motion.lost();
    EXPECT_FALSE(bench.motion.is_started());
  }
}

TEST(InertialMotion, OverASecondDeviationsGrowWithTheTime) {
  const std::vector<ImuSample> rest = {{0.0, Vector3d::Zero(), -gravity}, {5.0, Vector3d::Zero(), -gravity}};
  const ImuNoise noise{1e-9, 2e-3, 1e-9, 1e-9};
  const auto deviation = [&](double seconds) {
    InertialFilter filter(InertialState{}, gravity, {});
    filter.predict(*geometry::preintegrate(rest, 0.0, seconds, noise, {}, 10.0), Vector3d::Zero());
    return filter.deviations().velocity;
  };
  EXPECT_NEAR(deviation(0.1) / deviation(0.025), 2.0, 0.1);
  EXPECT_NEAR(deviation(2.0) / deviation(0.5), 4.0, 0.2);
}

TEST(InertialMotion, WithoutAnImuNothingIsPredicted) {
  InertialMotion motion(std::nullopt, true);
  SensorFrame frame;
  for (int i = 0; i < 100; ++i) {
    frame.timestamp = i / 30.0;
    motion.begin_frame(frame);
    motion.found(Isometry3d::Identity(), 0.0, [](double) { return std::optional(Isometry3d::Identity()); });
    EXPECT_FALSE(motion.is_started() || motion.step() || motion.prediction());
    EXPECT_FALSE(motion.contradicts(Isometry3d(Eigen::Translation3d(9, 9, 9)), 1.0));
  }
}

TEST(InertialMotion, BridgesAViewWithACovarianceThatGrows) {
  double chi_square = 0.0;
  const int runs = 20;
  for (int run = 0; run < runs; ++run) {
    InertialBench bench(4.2, false, 1.0, static_cast<std::uint64_t>(run) + 1);
    bench.track(3.0);
    bench.begin();
    const double before = bench.motion.prediction()->position_deviation;
    bench.motion.bridged(bench.motion.prediction()->T_camera_world);
    bench.last = bench.motion.prediction()->T_camera_world;
    bench.bridge(4.0);
    bench.begin();
    const InertialPrediction prediction = *bench.motion.prediction();
    EXPECT_LT(bench.distance(), 0.05);
    EXPECT_GT(prediction.position_deviation, 3.0 * before);
    const Isometry3d error = prediction.T_camera_world * bench.pose(bench.time).inverse();
    Eigen::Matrix<double, 6, 1> components;
    components << error.translation(), geometry::log_so3(Eigen::Matrix3d(error.linear()));
    chi_square += components.dot(prediction.covariance.ldlt().solve(components)) / (6.0 * runs);
  }
  // Above, the 99.9 % band of the mean of 120 squares. Below, room for errors that this world does not have, of the
  // gyroscope's scale, the calibration and the walk of gravity, and for deviations that the residual of the start has
  // enlarged: the covariance is too large rather than too small.
  EXPECT_GT(chi_square, 0.15);
  EXPECT_LT(chi_square, 1.5);
}

/// What a bridge goes on with: an error of it grows to centimetres within a second.
TEST(InertialMotion, KnowsTheVelocityWhenABridgeBegins) {
  for (const double unit : {1.0, 0.4}) {
    double squares = 0.0, chi_square = 0.0;
    const int runs = 20;
    for (int run = 0; run < runs; ++run) {
      InertialBench bench(6.5, false, unit, static_cast<std::uint64_t>(run) + 1);
      bench.track(6.0);
      ASSERT_TRUE(bench.motion.is_reliable()) << unit << " run " << run;
      const InertialFilter& filter = *bench.motion.filter();
      const Vector3d error = filter.state().velocity - bench.T_map_world.linear() * bench.state(bench.time).velocity;
      squares += error.squaredNorm() / runs;
      const double deviation = filter.deviations().velocity;
      chi_square += error.squaredNorm() / (3.0 * runs * deviation * deviation);
    }
    EXPECT_LT(std::sqrt(squares), 0.02) << unit << " [m/s]";
    EXPECT_LT(chi_square, 1.5) << unit << ": the deviation that it states";
  }
}

TEST(InertialMotion, OneCameraGetsItsScale) {
  InertialBench bench(6.5, false, 0.4);
  bench.track(4.9);
  EXPECT_FALSE(bench.motion.is_started());
  bench.track(6.0);
  ASSERT_TRUE(bench.motion.is_reliable());
  EXPECT_NEAR(bench.motion.scale(), 0.4, 0.004);
  bench.bridge(6.4);
  bench.begin();
  EXPECT_LT(0.4 * bench.distance(), 0.02);
}

TEST(InertialMotion, AWrongImuIsNeverRelied) {
  const auto exchanged = [](std::vector<ImuSample>& samples) {
    for (ImuSample& sample : samples) std::swap(sample.acceleration.x(), sample.acceleration.y());
  };
  const auto in_degrees = [](std::vector<ImuSample>& samples) {
    for (ImuSample& sample : samples) sample.angular_velocity *= 180.0 / EIGEN_PI;
  };
  for (const auto& change : {std::function<void(std::vector<ImuSample>&)>(exchanged),
                             std::function<void(std::vector<ImuSample>&)>(in_degrees)}) {
    InertialBench bench(6.0);
    bench.change = change;
    while (bench.frames < 180) {
      bench.begin();
      EXPECT_FALSE(bench.motion.is_reliable());
      bench.found(bench.measured(bench.time));
    }
  }
}

TEST(InertialMotion, MissingOrSaturatedMeasurementsBeginTheStartAgain) {
  const auto missing = [](std::vector<ImuSample>& samples) { samples.clear(); };
  const auto saturated = [](std::vector<ImuSample>& samples) { samples[1].angular_velocity.x() = 1000.0; };
  for (const auto& change : {std::function<void(std::vector<ImuSample>&)>(missing),
                             std::function<void(std::vector<ImuSample>&)>(saturated)}) {
    InertialBench bench(6.0);
    bench.track(3.0);
    ASSERT_TRUE(bench.motion.is_reliable());
    bench.change = change;
    bench.begin();
    bench.change = nullptr;
    EXPECT_FALSE(bench.motion.is_started());
    bench.found(bench.measured(bench.time));
    bench.track(6.0);
    EXPECT_TRUE(bench.motion.is_reliable());
  }
}

TEST(InertialMotion, ASampleThatComesAfterItsFrameIsNotMissed) {
  InertialBench bench(3.0);
  bench.change = [&](std::vector<ImuSample>& samples) {
    std::erase_if(samples, [&](const ImuSample& sample) { return sample.timestamp > bench.time; });
  };
  bench.track(3.0);
  EXPECT_TRUE(bench.motion.is_reliable());
}

TEST(InertialMotion, FollowsCorrectionsOfTheMap) {
  InertialBench bench(4.2);
  bench.track(3.0);
  bench.begin();
  const Isometry3d step = *bench.motion.step(), before = bench.motion.prediction()->T_camera_world;
  Isometry3d T_new_old = Isometry3d::Identity();
  T_new_old.linear() = exp_so3({0.1, -0.2, 0.3}).toRotationMatrix();
  T_new_old.translation() << 0.5, -0.3, 0.2;
  bench.last = *bench.last * T_new_old.inverse();
  bench.motion.follow_map(*bench.last);
  EXPECT_LT((bench.motion.step()->matrix() - step.matrix()).norm(), 1e-9);
  EXPECT_LT((bench.motion.prediction()->T_camera_world.matrix() - (before * T_new_old.inverse()).matrix()).norm(),
            1e-9);
  bench.motion.bridged(bench.motion.prediction()->T_camera_world);
  bench.last = bench.motion.prediction()->T_camera_world;
  bench.T_map_world = T_new_old * bench.T_map_world;
  bench.bridge(3.4);
  bench.begin();
  EXPECT_LT(bench.distance(), 0.01) << "gravity and velocity turn as the map does";
}

TEST(InertialMotion, PosesThatMoveWithAPersonContradictIt) {
  InertialBench bench(6.0);
  bench.track(3.0);
  // Images of which somebody at 0.5 m/s determines the pose.
  int contradicted = 0;
  for (int i = 1; i <= 20; ++i) {
    bench.begin();
    const Isometry3d right = bench.measured(bench.time);
    EXPECT_FALSE(bench.motion.contradicts(right, 1.0)) << i;
    const Isometry3d wrong = right * Eigen::Translation3d(0.5 * i / 30.0, 0.0, 0.0);
    if (bench.motion.contradicts(wrong, 1.0)) {
      ++contradicted;
      bench.last = bench.motion.prediction()->T_camera_world;
      bench.motion.bridged(*bench.last);
    } else {
      bench.found(wrong);
    }
  }
  EXPECT_GE(contradicted, 17);
}

TEST(InertialMotion, ImagesThatContradictItForLongEndIt) {
  InertialBench bench(8.0);
  bench.track(3.0);
  const auto moved = [&] { return bench.measured(bench.time) * Eigen::Translation3d(0.3, 0.0, 0.0); };
  for (int i = 0; i < 20; ++i) {
    bench.begin();
    bench.found(moved());
  }
  EXPECT_FALSE(bench.motion.is_started());
  while (bench.frames < 180) {
    bench.begin();
    bench.found(moved());
  }
  EXPECT_TRUE(bench.motion.is_reliable()) << "begins again where the images say";
}

TEST(InertialMotion, ARefusedPoseThatManyPointsHoldEndsAWrongEstimate) {
  InertialBench bench(8.0);
  bench.track(3.0);
  // Bridges while somebody hides the view, then frames of whose poses every other one contradicts the prediction.
  const auto moved = [&] { return bench.measured(bench.time) * Eigen::Translation3d(0.3, 0.0, 0.0); };
  const auto refuse = [&] {
    bench.begin();
    bench.motion.count_refusal(moved(), 1.0);
    bench.motion.count_refusal(moved(), 1.0);  // another method of the same frame
  };
  for (int i = 0; i < 20; ++i) {
    refuse();
    ASSERT_TRUE(bench.motion.contradicts(moved(), 1.0)) << i;
    bench.last = bench.motion.prediction()->T_camera_world;
    bench.motion.bridged(*bench.last);
    bench.track(bench.frames / 30.0 + 1.0 / 30.0);
  }
  for (int i = 0; i < 4; ++i) {
    refuse();
    ASSERT_TRUE(bench.motion.is_reliable()) << i;
    bench.last = bench.motion.prediction()->T_camera_world;
    bench.motion.bridged(*bench.last);
  }
  refuse();
  EXPECT_FALSE(bench.motion.is_started() || bench.motion.contradicts(moved(), 1.0));
  bench.found(moved());
  while (bench.frames < 230) {
    bench.begin();
    bench.found(moved());
  }
  EXPECT_TRUE(bench.motion.is_reliable()) << "begins again where the images say";
}

TEST(InertialMotion, CorrectsTheCalibrationWhileTracking) {
  InertialBench bench(8.0);
  const Eigen::Matrix3d mounting = exp_so3({0.015, -0.02, 0.01}).toRotationMatrix();
  for (ImuSample& sample : bench.samples) {
    sample.timestamp += 0.006;
    sample.angular_velocity = mounting.transpose() * sample.angular_velocity;
    sample.acceleration = mounting.transpose() * sample.acceleration;
  }
  bench.track(7.0);
  ASSERT_TRUE(bench.motion.is_reliable());
  const InertialFilter& filter = *bench.motion.filter();
  EXPECT_LT(geometry::log_so3(Eigen::Matrix3d(mounting.transpose() * filter.mounting())).norm(), 0.002);
  EXPECT_NEAR(filter.time_offset(), 0.006, 0.0005);
  bench.bridge(7.5);
  bench.begin();
  EXPECT_LT(bench.distance(), 0.03);
}

TEST(InertialMotion, AFewMatchesCorrectThePrediction) {
  InertialBench bench(5.0);
  bench.track(3.0);
  bench.bridge(4.5);
  bench.begin();
  const double before = bench.distance(), deviation = bench.motion.prediction()->position_deviation;
  const Eigen::Matrix<double, 6, 6> covariance = 1e-6 * Eigen::Matrix<double, 6, 6>::Identity();
  EXPECT_FALSE(bench.motion.correct(bench.pose(bench.time) * Eigen::Translation3d(1.0, 0.0, 0.0), covariance, false));
  EXPECT_DOUBLE_EQ(bench.distance(), before) << "a pose that contradicts it corrects nothing";
  EXPECT_TRUE(bench.motion.correct(bench.pose(bench.time), covariance, false));
  EXPECT_LT(bench.distance(), 0.3 * before);
  EXPECT_LT(bench.motion.prediction()->position_deviation, 0.5 * deviation);
}

/// What a run of some seconds leaves for the next one.
MapInertia estimates_of_a_run(double seconds, double unit = 1.0) {
  InertialBench bench(seconds, false, unit);
  bench.track(seconds);
  EXPECT_TRUE(bench.motion.is_reliable());
  return *bench.motion.estimates();
}

TEST(InertialMotion, BeginsWithTheEstimatesOfTheMap) {
  for (const double unit : {1.0, 0.4}) {  // a pair, and one camera
    const MapInertia known = estimates_of_a_run(unit == 1.0 ? 4.0 : 7.0, unit);
    InertialBench bench(2.0, false, unit, 7);
    bench.motion.begin_with(known);
    bench.track(0.1);
    EXPECT_TRUE(bench.motion.is_started());
    bench.track(0.5);
    ASSERT_TRUE(bench.motion.is_reliable()) << unit;
    EXPECT_NEAR(bench.motion.scale(), unit, 0.01 * unit);
    bench.bridge(1.0);
    bench.begin();
    EXPECT_LT(unit * bench.distance(), 0.03);
  }
}

TEST(InertialMotion, EstimatesOfAnotherImuGiveGravityAlone) {
  MapInertia known = estimates_of_a_run(4.0);
  const Vector3d gyroscope = known.bias.gyroscope;
  known.bias.gyroscope << 0.5, -0.5, 0.5;
  known.T_body_camera.translation().x() += 0.01;
  InertialBench bench(3.0, false, 1.0, 7);
  bench.motion.begin_with(known);
  bench.track(0.1);
  ASSERT_TRUE(bench.motion.is_started());
  EXPECT_LT((bench.motion.filter()->state().bias.gyroscope).norm(), 0.2);
  bench.track(2.0);
  ASSERT_TRUE(bench.motion.is_reliable());
  EXPECT_LT((bench.motion.filter()->state().bias.gyroscope - gyroscope).norm(), 0.005);
}

TEST(InertialMotion, WrongEstimatesOfTheMapAreGivenUp) {
  MapInertia known = estimates_of_a_run(4.0);
  known.gravity = -known.gravity;
  InertialBench bench(5.0, false, 1.0, 7);
  bench.motion.begin_with(known);
  bench.track(2.0);
  EXPECT_FALSE(bench.motion.is_started());
  bench.track(5.0);
  ASSERT_TRUE(bench.motion.is_reliable());
  EXPECT_GT(bench.motion.estimates()->gravity.dot(known.gravity), -97.0);
  EXPECT_LT(bench.motion.estimates()->gravity.dot(known.gravity), -90.0);
}

TEST(InertialMotion, AWrongFirstPoseDoesNotCostTheEstimates) {
  InertialBench bench(3.0, false, 1.0, 7);
  bench.motion.begin_with(estimates_of_a_run(4.0));
  bench.track(0.02);
  bench.begin();
  bench.found(bench.measured(bench.time) * Eigen::Translation3d(0.8, 0.0, 0.0));
  bench.track(1.5);
  EXPECT_TRUE(bench.motion.is_reliable());
}

TEST(InertialMotion, GoesOnWhereTheMapFindsTheCamera) {
  InertialBench bench(5.0);
  bench.track(3.0);
  ASSERT_TRUE(bench.motion.is_reliable());
  const Vector3d gyroscope = bench.motion.filter()->state().bias.gyroscope;
  bench.begin();
  const Isometry3d found = bench.measured(bench.time) * Eigen::Translation3d(0.5, 0.0, 0.0);
  ASSERT_TRUE(bench.motion.contradicts(found, 1.0));
  bench.motion.relocated();
  bench.found(found);
  ASSERT_TRUE(bench.motion.is_started());
  EXPECT_LT((bench.motion.filter()->state().bias.gyroscope - gyroscope).norm(), 1e-9);
  for (int i = 0; i < 15; ++i) {
    bench.begin();
    bench.found(bench.measured(bench.time) * Eigen::Translation3d(0.5, 0.0, 0.0));
  }
  EXPECT_TRUE(bench.motion.is_reliable());
}

TEST(InertialMotion, AfterALongLossItBeginsWithWhatItKnew) {
  InertialBench bench(16.0, true);  // the speed of the motion grows without bound
  bench.track(3.0);
  ASSERT_TRUE(bench.motion.is_reliable());
  while (bench.frames < 15 * 30) {
    bench.begin();
    bench.motion.lost();
  }
  EXPECT_FALSE(bench.motion.is_started());
  bench.track(15.5);
  EXPECT_TRUE(bench.motion.is_reliable());
}

}  // namespace
}  // namespace holdfast
