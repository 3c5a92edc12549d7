// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/geometry/preintegration.hpp"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <vector>

#include "geometry/inertial_motion.hpp"
#include "holdfast/core/median.hpp"
#include "holdfast/core/random.hpp"

namespace holdfast::geometry {
namespace {

using namespace inertial;

using inertial_motion::gravity;
using inertial_motion::RecordedFlight;
using inertial_motion::true_samples;
using inertial_motion::true_state;

Eigen::Vector3d normal(Random& random, double deviation) {
  return deviation * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
}

struct Measurement {
  Eigen::Vector3d rate, force;
  double interval;
};

/// A hand that turns fast and shakes.
std::vector<Measurement> shaken_hand(Random& random, int count, double interval) {
  std::vector<Measurement> all;
  const Eigen::Vector3d phase = normal(random, 3.0);
  for (int i = 0; i < count; ++i) {
    const double t = i * interval;
    const Eigen::Vector3d swing((4.0 * t + phase.array()).sin());
    all.push_back({3.0 * swing, Eigen::Vector3d(1, -9, 3) + 5.0 * swing.reverse() + normal(random, 0.5), interval});
  }
  return all;
}

Preintegration integrated(const std::vector<Measurement>& measurements, const ImuNoise& noise = {},
                          const ImuBias& bias = {}) {
  Preintegration result(noise, bias);
  for (const Measurement& m : measurements) result.integrate(m.rate, m.force, m.interval);
  return result;
}

InertialState some_state(Random& random) {
  InertialState state;
  state.T_world_body.linear() = exp_so3(normal(random, 1.0)).toRotationMatrix();
  state.T_world_body.translation() = normal(random, 2.0);
  state.velocity = normal(random, 1.0);
  state.bias = {normal(random, 0.02), normal(random, 0.2)};
  return state;
}

using Matrix3l = Eigen::Matrix<long double, 3, 3>;
using Vector3l = Eigen::Matrix<long double, 3, 1>;

Matrix3l hat_long(const Vector3l& v) {
  Matrix3l m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

TEST(Preintegration, AgreesWithTheEquationsOfMotionInLongDouble) {
  Random random(1);
  const std::vector<Measurement> measurements = shaken_hand(random, 40, 0.005);
  Matrix3l R = Matrix3l::Identity();
  Vector3l v = Vector3l::Zero(), p = Vector3l::Zero();
  for (const Measurement& m : measurements) {
    // dR = R hat(w), dv = R a, dp = v by Runge and Kutta's method of fourth order.
    const Matrix3l w = hat_long(m.rate.cast<long double>());
    const Vector3l a = m.force.cast<long double>();
    constexpr int steps = 50;
    const long double h = static_cast<long double>(m.interval) / steps;
    for (int i = 0; i < steps; ++i) {
      const Matrix3l r1 = R * w, r2 = (R + h / 2 * r1) * w, r3 = (R + h / 2 * r2) * w, r4 = (R + h * r3) * w;
      const Vector3l v1 = R * a, v2 = (R + h / 2 * r1) * a, v3 = (R + h / 2 * r2) * a, v4 = (R + h * r3) * a;
      p += h * v + h * h / 6 * (v1 + v2 + v3);
      v += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
      R += h / 6 * (r1 + 2 * r2 + 2 * r3 + r4);
    }
  }
  const Preintegration result = integrated(measurements);
  EXPECT_LT((result.delta().rotation.cast<long double>() - R).norm(), 1e-12L);
  EXPECT_LT((result.delta().velocity.cast<long double>() - v).norm(), 1e-11L);
  EXPECT_LT((result.delta().position.cast<long double>() - p).norm(), 1e-12L);
  EXPECT_NEAR(result.duration(), 0.2, 1e-12);
}

TEST(Preintegration, AStepIsExactHoweverFastItTurns) {
  const Eigen::Vector3d rate(20, -30, 10), force(3, 2, -9);
  Preintegration one, many;
  one.integrate(rate, force, 0.2);  // 7.5 rad
  for (int i = 0; i < 1000; ++i) many.integrate(rate, force, 0.0002);
  EXPECT_LT((one.delta().rotation - many.delta().rotation).norm(), 1e-11);
  EXPECT_LT((one.delta().velocity - many.delta().velocity).norm(), 1e-11);
  EXPECT_LT((one.delta().position - many.delta().position).norm(), 1e-12);
  EXPECT_LT((one.bias_jacobian() - many.bias_jacobian()).norm(), 1e-9);
}

TEST(Preintegration, BiasJacobianAgreesWithDifferences) {
  Random random(2);
  for (const double interval : {0.001, 0.005, 0.05}) {
    const std::vector<Measurement> measurements = shaken_hand(random, 40, interval);
    const ImuBias bias{normal(random, 0.05), normal(random, 0.3)};
    const Preintegration at = integrated(measurements, {}, bias);
    const double h = 1e-5;
    Eigen::Matrix<double, 9, 6> numeric;
    for (int i = 0; i < 6; ++i) {
      const auto changed = [&](double by) {
        ImuBias other = bias;
        (i < 3 ? other.gyroscope[i] : other.accelerometer[i - 3]) += by;
        return integrated(measurements, {}, other).delta();
      };
      const InertialDelta plus = changed(h), minus = changed(-h);
      numeric.col(i) << plus.position - minus.position,
          log_so3(Eigen::Matrix3d(minus.rotation.transpose() * plus.rotation)), plus.velocity - minus.velocity;
    }
    numeric /= 2 * h;
    EXPECT_LT((at.bias_jacobian() - numeric).cwiseAbs().maxCoeff(), 1e-6) << interval;
  }
}

TEST(Preintegration, ResidualJacobiansAgreeWithDifferences) {
  Random random(3);
  const Preintegration motion = integrated(shaken_hand(random, 100, 0.005));
  const InertialState first = some_state(random);  // its biases are far from those of the preintegration
  Vector15d off;
  for (double& each : off) each = 0.1 * random.normal();
  const InertialState second = disturbed(motion.predict(first, gravity), off);
  InertialJacobians jacobians;
  motion.residual(first, second, gravity, &jacobians);
  const double h = 1e-6;
  const auto difference = [&](const std::function<Vector15d(double)>& residual) -> Vector15d {
    return (residual(h) - residual(-h)) / (2 * h);
  };
  for (int i = 0; i < 15; ++i) {
    const Vector15d unit = Vector15d::Unit(i);
    const Vector15d by_first =
        difference([&](double d) { return motion.residual(disturbed(first, d * unit), second, gravity); });
    const Vector15d by_second =
        difference([&](double d) { return motion.residual(first, disturbed(second, d * unit), gravity); });
    EXPECT_LT((jacobians.first.col(i) - by_first).cwiseAbs().maxCoeff(), 1e-6) << i;
    EXPECT_LT((jacobians.second.col(i) - by_second).cwiseAbs().maxCoeff(), 1e-6) << i;
  }
  for (int i = 0; i < 3; ++i) {
    const Vector15d by_gravity =
        difference([&](double d) { return motion.residual(first, second, gravity + d * Eigen::Vector3d::Unit(i)); });
    EXPECT_LT((jacobians.gravity.col(i) - by_gravity).cwiseAbs().maxCoeff(), 1e-6) << i;
  }
}

TEST(Preintegration, ResidualOfThePredictionIsZero) {
  Random random(4);
  const Preintegration motion = integrated(shaken_hand(random, 100, 0.005));
  const InertialState first = some_state(random);
  EXPECT_LT(motion.residual(first, motion.predict(first, gravity), gravity).norm(), 1e-12);
}

TEST(Preintegration, PredictedCovarianceIsThatOfTheStatePropagated) {
  Random random(5);
  const ImuNoise none{0, 0, 0, 0};
  const Preintegration motion = integrated(shaken_hand(random, 100, 0.005), none);
  const InertialState first = some_state(random);
  const InertialState at = motion.predict(first, gravity);
  Matrix15d transition;
  const double h = 1e-6;
  for (int i = 0; i < 15; ++i) {
    const InertialState moved = motion.predict(disturbed(first, h * Vector15d::Unit(i)), gravity);
    transition.col(i) << moved.T_world_body.translation() - at.T_world_body.translation(),
        log_so3(Eigen::Matrix3d(at.T_world_body.linear().transpose() * moved.T_world_body.linear())),
        moved.velocity - at.velocity, moved.bias.gyroscope - first.bias.gyroscope,
        moved.bias.accelerometer - first.bias.accelerometer;
  }
  transition /= h;
  const Matrix15d covariance = Vector15d::LinSpaced(0.1, 1.5).asDiagonal();
  const Matrix15d expected = transition * covariance * transition.transpose();
  EXPECT_LT((motion.predicted_covariance(first, covariance, gravity) - expected).cwiseAbs().maxCoeff(), 1e-4);
}

/// Normalised estimation error squared: residuals of simulated noise and bias walk against the covariance.
TEST(Preintegration, CovarianceIsConsistentOverMonteCarlo) {
  constexpr int runs = 200, steps = 40;
  constexpr double interval = 0.01;
  // The walk is strong, so that its share in the delta counts.
  const ImuNoise noise{2e-3, 2e-2, 5e-3, 5e-2};
  Random random(6);
  double whole = 0.0;
  std::array<double, 5> parts{};
  for (int run = 0; run < runs; ++run) {
    const std::vector<Measurement> truth = shaken_hand(random, steps, interval);
    const InertialState first = some_state(random);
    Preintegration measured(noise, first.bias);
    ImuBias bias = first.bias;
    for (const Measurement& m : truth) {
      // One after the other: the order of a call's arguments is the compiler's, and with it the sample.
      const Eigen::Vector3d force_noise = normal(random, noise.accelerometer_noise_density / std::sqrt(interval));
      const Eigen::Vector3d rate_noise = normal(random, noise.gyroscope_noise_density / std::sqrt(interval));
      measured.integrate(m.rate + bias.gyroscope + rate_noise, m.force + bias.accelerometer + force_noise, interval);
      bias.gyroscope += normal(random, noise.gyroscope_random_walk * std::sqrt(interval));
      bias.accelerometer += normal(random, noise.accelerometer_random_walk * std::sqrt(interval));
    }
    InertialState without_bias = first;
    without_bias.bias = {};
    InertialState second = integrated(truth).predict(without_bias, gravity);
    second.bias = bias;
    const Vector15d error = measured.residual(first, second, gravity);
    whole += error.dot(measured.covariance().ldlt().solve(error)) / runs;
    for (int i = 0; i < 5; ++i) {
      const Eigen::Vector3d part = error.segment<3>(3 * i);
      const Eigen::Matrix3d covariance = measured.covariance().block<3, 3>(3 * i, 3 * i);
      parts[static_cast<std::size_t>(i)] += part.dot(covariance.ldlt().solve(part)) / runs;
    }
  }
  // The mean of `runs` chi-squares of n degrees has the variance 2 n / runs; 95 % within 1.96 deviations.
  EXPECT_NEAR(whole, 15.0, 1.96 * std::sqrt(2.0 * 15.0 / runs));
  for (const double part : parts) EXPECT_NEAR(part, 3.0, 3.3 * std::sqrt(2.0 * 3.0 / runs));
}

TEST(Preintegrate, PredictsAMotionInClosedFormBetweenAnyTwoTimes) {
  const std::vector<ImuSample> samples = true_samples(0.0, 2.0, 200.0);
  for (const auto& [begin, end] : {std::pair(0.0, 1.0), {0.5012, 1.5037}, {0.1001, 0.1004}}) {
    const auto motion = preintegrate(samples, begin, end, {}, {});
    ASSERT_TRUE(motion);
    EXPECT_NEAR(motion->duration(), end - begin, 1e-12);
    const InertialState predicted = motion->predict(true_state(begin), gravity), truth = true_state(end);
    EXPECT_LT((predicted.T_world_body.translation() - truth.T_world_body.translation()).norm(), 2e-4);
    EXPECT_LT((predicted.T_world_body.linear() - truth.T_world_body.linear()).norm(), 2e-4);
    EXPECT_LT((predicted.velocity - truth.velocity).norm(), 3e-4);
  }
}

TEST(Preintegrate, IsEmptyWithoutMeasurementsForTheWholeTime) {
  std::vector<ImuSample> samples = true_samples(1.0, 2.0, 100.0);
  EXPECT_TRUE(preintegrate(samples, 1.0, 2.0, {}, {}));
  EXPECT_FALSE(preintegrate(samples, 0.99, 1.5, {}, {}));
  EXPECT_FALSE(preintegrate(samples, 1.5, 2.01, {}, {}));
  EXPECT_FALSE(preintegrate(samples, 1.5, 1.5, {}, {}));
  EXPECT_FALSE(preintegrate({}, 1.0, 1.5, {}, {}));
  samples.erase(samples.begin() + 40, samples.begin() + 55);  // from 1.40 to 1.54 s
  EXPECT_FALSE(preintegrate(samples, 1.3, 1.6, {}, {}));
  EXPECT_TRUE(preintegrate(samples, 1.3, 1.6, {}, {}, 0.2));
  EXPECT_TRUE(preintegrate(samples, 1.0, 1.39, {}, {})) << "the gap comes later";
}

/// EuRoC V1_01_easy: from the true state, with the velocity by differences of the true positions, over 0.5 s. The true
/// orientations of this flight are tilted by 2 degrees, which the estimated bias of the accelerometer absorbs.
TEST(PreintegrationData, PredictsARealFlight) {
  const std::optional<std::filesystem::path> folder = inertial_motion::flight_folder();
  if (!folder) GTEST_SKIP() << "HOLDFAST_DATA does not name the folder with euroc_v101_imu";
  const RecordedFlight flight = inertial_motion::read_flight(*folder);
  ASSERT_GT(flight.body.size(), 2000U);
  const ImuNoise noise{1.6968e-04, 2.0e-03, 1.9393e-05, 3.0e-03};
  const Eigen::Vector3d down(0, 0, -9.81);
  const auto state = [&](std::size_t i) {
    InertialState result;
    result.T_world_body = flight.body[i].T_world_camera;
    result.velocity =
        (flight.body[i + 1].T_world_camera.translation() - flight.body[i - 1].T_world_camera.translation()) /
        (flight.body[i + 1].timestamp - flight.body[i - 1].timestamp);
    return result;
  };
  constexpr std::size_t apart = 10;  // poses, 20 of them each second
  ImuBias bias;
  std::vector<double> metres, degrees;
  for (int iteration = 0; iteration < 3; ++iteration) {
    Eigen::Matrix<double, 6, 6> hessian = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> gradient = Eigen::Matrix<double, 6, 1>::Zero();
    metres.clear(), degrees.clear();
    for (std::size_t i = 1; i + apart + 1 < flight.body.size(); i += 5) {
      const auto motion =
          preintegrate(flight.samples, flight.body[i].timestamp, flight.body[i + apart].timestamp, noise, bias);
      if (!motion) continue;
      InertialState first = state(i), second = state(i + apart);
      first.bias = second.bias = bias;
      const Eigen::Matrix<double, 9, 1> error = motion->residual(first, second, down).head<9>();
      metres.push_back(error.segment<3>(position).norm());
      degrees.push_back(error.segment<3>(rotation).norm() * 180.0 / EIGEN_PI);
      const Eigen::Matrix<double, 9, 6> jacobian = -motion->bias_jacobian();
      hessian += jacobian.transpose() * jacobian;
      gradient += jacobian.transpose() * error;
    }
    const Eigen::Matrix<double, 6, 1> step = -hessian.ldlt().solve(gradient);
    bias.gyroscope += step.head<3>(), bias.accelerometer += step.tail<3>();
  }
  ASSERT_GT(metres.size(), 400U);
  EXPECT_LT(upper_median(metres), 0.03);
  EXPECT_LT(upper_median(degrees), 0.3);
}

}  // namespace
}  // namespace holdfast::geometry
