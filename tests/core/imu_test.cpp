// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/imu.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "holdfast/core/imu_plausibility.hpp"
#include "holdfast/core/imu_timeline.hpp"
#include "holdfast/core/random.hpp"

namespace holdfast {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<double> stamps(const std::vector<ImuSample>& samples) {
  std::vector<double> result;
  for (const ImuSample& sample : samples) result.push_back(sample.timestamp);
  return result;
}

ImuSample resting(double timestamp) {
  return {timestamp, Eigen::Vector3d::Zero(), standard_gravity * Eigen::Vector3d::UnitZ()};
}

/// A camera in a hand that looks around for `seconds`: pitch and roll of `degrees`, with noise.
std::vector<ImuSample> looking_around(double seconds, double degrees, double rate = 200.0) {
  std::vector<ImuSample> samples;
  Random random(1);
  const double amplitude = degrees * EIGEN_PI / 180.0;
  const auto noise = [&](double deviation) {
    const double x = random.normal(), y = random.normal(), z = random.normal();
    return Eigen::Vector3d(deviation * Eigen::Vector3d(x, y, z));
  };
  for (double t = 0.0; t < seconds; t += 1.0 / rate) {
    const auto pose = [&](double time) {
      return Eigen::Matrix3d(Eigen::AngleAxisd(0.5 * time, Eigen::Vector3d::UnitZ()) *
                             Eigen::AngleAxisd(amplitude * std::sin(2.0 * time), Eigen::Vector3d::UnitX()) *
                             Eigen::AngleAxisd(amplitude * std::cos(1.3 * time), Eigen::Vector3d::UnitY()));
    };
    constexpr double h = 1e-4;
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(pose(t - h).transpose() * pose(t + h)));
    const Eigen::Vector3d shake(0.4 * std::sin(9 * t), 0.5 * std::cos(7 * t), 0.3 * std::sin(11 * t));
    samples.push_back({t, turn.angle() / (2 * h) * turn.axis() + noise(0.003),
                       pose(t).transpose() * (shake + standard_gravity * Eigen::Vector3d::UnitZ()) + noise(0.03)});
  }
  return samples;
}

template <class Change>
std::vector<std::string> suspicions_of(std::vector<ImuSample> samples, Change change,
                                       const ImuExpectation& expected = {}) {
  for (ImuSample& sample : samples) change(sample);
  return imu_suspicions(samples, expected);
}

TEST(Imu, KnownSensorsAreValidAndNamed) {
  EXPECT_THAT(imu_names(), ElementsAre("adis16448", "bmi055", "bmi085", "bmi160"));
  for (const std::string& name : imu_names()) {
    EXPECT_EQ(find_imu(name)->name, name);
    EXPECT_EQ(find_imu(name)->trouble(), "") << name;
  }
  EXPECT_FALSE(find_imu("bmi999"));
}

TEST(Imu, TroubleNamesWhatCannotBe) {
  const auto trouble = [](auto change) {
    ImuCalibration imu;
    change(imu);
    return imu.trouble();
  };
  EXPECT_EQ(trouble([](ImuCalibration&) {}), "");
  EXPECT_THAT(trouble([](ImuCalibration& imu) { imu.T_body_camera.linear() *= 1.1; }), HasSubstr("no rigid motion"));
  EXPECT_THAT(trouble([](ImuCalibration& imu) { imu.T_body_camera.translation().x() = 64.7; }), HasSubstr("metres"));
  EXPECT_THAT(trouble([](ImuCalibration& imu) { imu.noise.gyroscope_random_walk = 0.0; }), HasSubstr("not positive"));
  EXPECT_THAT(trouble([](ImuCalibration& imu) { imu.time_offset = 12.0; }), HasSubstr("time offset"));
}

TEST(ImuTimeline, DealsSamplesWithOneBeyondEachEnd) {
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 100; ++i) samples.push_back(resting(0.01 * i));
  ImuTimeline timeline(samples);
  EXPECT_THAT(stamps(timeline.take(0.105)), ElementsAre(0.10, 0.11)) << "the first frame has what surrounds it";
  EXPECT_THAT(stamps(timeline.take(0.125)), ElementsAre(0.10, 0.11, 0.12, 0.13));
  EXPECT_THAT(stamps(timeline.take(0.13)), ElementsAre(0.12, 0.13));
  EXPECT_THAT(timeline.take(0.9), testing::SizeIs(78)) << "frames between were passed over";
  EXPECT_THAT(stamps(timeline.take(2.0)), testing::Contains(1.0));
  EXPECT_THAT(stamps(timeline.take(3.0)), ElementsAre(1.0)) << "after the last sample";
}

TEST(ImuTimeline, SamplesOfADroppedFrameAreThoseOfTheNext) {
  std::vector<ImuSample> samples = {resting(0.0), resting(0.1), resting(0.2)};
  append_imu(samples, {resting(0.1), resting(0.2), resting(0.3)});
  EXPECT_THAT(stamps(samples), ElementsAre(0.0, 0.1, 0.2, 0.3));
}

TEST(ImuTimeline, StampsAreByTheClockOfTheCamera) {
  ImuTimeline timeline({resting(5.0), resting(5.1), resting(5.2)}, 4.0);
  EXPECT_NEAR(timeline.take(1.05).front().timestamp, 1.0, 1e-12);
  EXPECT_NEAR(timeline.take(1.15).back().timestamp, 1.2, 1e-12);
}

TEST(ImuTimeline, SamplesThatMissTheEndsByLittleAreRepeatedThere) {
  ImuCalibration imu;
  imu.rate = 10.0;
  const std::vector<ImuSample> samples = {resting(1.0), resting(1.1), resting(1.2)};
  EXPECT_THAT(stamps(covering(samples, 1.0, 1.2, imu)), ElementsAre(1.0, 1.1, 1.2));
  EXPECT_THAT(stamps(covering(samples, 0.85, 1.35, imu)), ElementsAre(0.85, 1.0, 1.1, 1.2, 1.35));
  EXPECT_THAT(stamps(covering(samples, 0.75, 1.45, imu)), ElementsAre(1.0, 1.1, 1.2)) << "a gap";
  EXPECT_THAT(covering({}, 1.0, 1.2, imu), IsEmpty());
}

TEST(ImuTimeline, AMeasurementAtTheEndOfTheRangeIsSaturated) {
  ImuCalibration imu;
  imu.gyroscope_range = 10.0, imu.accelerometer_range = 40.0;
  std::vector<ImuSample> samples = {resting(0.0), resting(0.1)};
  EXPECT_FALSE(has_saturated(samples, imu));
  samples[1].angular_velocity.y() = -10.0;
  EXPECT_TRUE(has_saturated(samples, imu));
  samples[1] = resting(0.1);
  samples[1].acceleration.x() = 40.0;
  EXPECT_TRUE(has_saturated(samples, imu));
}

TEST(ImuSuspicions, PlausibleMeasurementsHaveNone) {
  for (const double degrees : {0.0, 2.0, 10.0, 40.0})
    EXPECT_THAT(imu_suspicions(looking_around(20, degrees)), IsEmpty());
  EXPECT_THAT(imu_suspicions(looking_around(20, 20, 100)), IsEmpty());
  EXPECT_THAT(imu_suspicions({}), IsEmpty());
  EXPECT_THAT(suspicions_of(looking_around(20, 10), [](ImuSample& s) { s.angular_velocity.x() += 0.05; }), IsEmpty());
}

TEST(ImuSuspicions, UnitsOfAccelerations) {
  EXPECT_THAT(suspicions_of(looking_around(5, 10), [](ImuSample& s) { s.acceleration /= standard_gravity; }),
              ElementsAre(AllOf(HasSubstr("multiples of g"), HasSubstr("9.80665"))));
  EXPECT_THAT(suspicions_of(looking_around(5, 10), [](ImuSample& s) { s.acceleration *= 1000 / standard_gravity; }),
              ElementsAre(HasSubstr("thousandths of g")));
}

TEST(ImuSuspicions, MissingGravity) {
  EXPECT_THAT(suspicions_of(looking_around(5, 10),
                            [](ImuSample& s) { s.acceleration -= standard_gravity * s.acceleration.normalized(); }),
              testing::Contains(AllOf(HasSubstr("subtracted"), HasSubstr("raw accelerometer"))));
}

TEST(ImuSuspicions, DegreesPerSecond) {
  const auto in_degrees = [](ImuSample& s) { s.angular_velocity *= 180.0 / EIGEN_PI; };
  EXPECT_THAT(suspicions_of(looking_around(20, 40), in_degrees), ElementsAre(HasSubstr("divide them by 57.2958")))
      << "faster than gyroscopes";
  EXPECT_THAT(suspicions_of(looking_around(20, 10), in_degrees), ElementsAre(HasSubstr("divide them by 57.2958")))
      << "slow";
}

TEST(ImuSuspicions, AxesOfTheGyroscope) {
  EXPECT_THAT(suspicions_of(looking_around(20, 30), [](ImuSample& s) { s.angular_velocity *= -1.0; }),
              ElementsAre(HasSubstr("they fit as (-x, -y, -z)")));
  EXPECT_THAT(suspicions_of(looking_around(20, 30),
                            [](ImuSample& s) {
                              const Eigen::Vector3d w = s.angular_velocity;
                              s.angular_velocity << w.y(), -w.x(), w.z();
                            }),
              ElementsAre(HasSubstr("they fit as (-y, x, z)")));
}

TEST(ImuSuspicions, ExchangedColumns) {
  EXPECT_THAT(
      suspicions_of(looking_around(20, 10), [](ImuSample& s) { std::swap(s.angular_velocity, s.acceleration); }),
      testing::Contains(HasSubstr("look exchanged")));
}

TEST(ImuSuspicions, GapsRateAndSaturation) {
  std::vector<ImuSample> samples = looking_around(20, 10);
  EXPECT_THAT(imu_suspicions(samples, {100.0, 0, 0}),
              ElementsAre(HasSubstr("200 times a second, and 'rate' says 100")));
  EXPECT_THAT(imu_suspicions(samples, {200.0, 0, 9.5}), ElementsAre(HasSubstr("end of the sensor's range")));
  samples.erase(samples.begin() + 1000, samples.begin() + 1100);
  EXPECT_THAT(imu_suspicions(samples, {200.0, 30.0, 40.0}),
              ElementsAre(AllOf(HasSubstr("1 gap,"), HasSubstr("0.505 s at 4.995"))));
}

}  // namespace
}  // namespace holdfast
