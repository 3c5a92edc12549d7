// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/geometry/path_smoothing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "holdfast/core/random.hpp"

namespace holdfast::geometry {
namespace {

constexpr double interval = 1.0 / 30.0;

/// A hand that swings, seen with errors.
struct Path {
  std::vector<double> times;
  std::vector<Eigen::Vector3d> truth, measured;

  Path(int count, double deviation, double frequency = 2.0) {
    Random random(5);
    for (int i = 0; i < count; ++i) {
      const double time = interval * i, phase = frequency * time;
      times.push_back(100.0 + time);
      truth.emplace_back(0.3 * std::sin(phase), 0.2 * std::cos(0.7 * phase), 0.5 * time);
      measured.emplace_back(truth.back() +
                            deviation * Eigen::Vector3d(random.normal(), random.normal(), random.normal()));
    }
  }
  double error(const std::vector<Eigen::Vector3d>& positions) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) sum += (positions[i] - truth[i]).squaredNorm();
    return std::sqrt(sum / static_cast<double>(truth.size()));
  }
  std::vector<Eigen::Vector3d> smoothed() const { return smooth_path(times, measured); }
};

TEST(PathSmoothing, RemovesErrorsThatChangeFromFrameToFrame) {
  for (const auto& [deviation, share] : {std::pair(0.0005, 0.85), std::pair(0.002, 0.6), std::pair(0.005, 0.5)}) {
    const Path path(300, deviation);
    EXPECT_LT(path.error(path.smoothed()), share * path.error(path.measured)) << deviation;
  }
}

TEST(PathSmoothing, KeepsAFastPath) {
  const Path exact(300, 0.0);
  EXPECT_LT(exact.error(exact.smoothed()), 0.0005);
  // Up to 30 m/s^2, as no hand can: little may be lost.
  const Path fast(300, 0.001, 10.0);
  EXPECT_LT(fast.error(fast.smoothed()), 3.0 * fast.error(fast.measured));
  // A jolt of 2 cm at 4 Hz in a quiet path.
  Path jolt(300, 0.0005);
  for (std::size_t i = 150; i < 165; ++i)
    for (std::vector<Eigen::Vector3d>* positions : {&jolt.truth, &jolt.measured})
      (*positions)[i].x() += 0.02 * std::sin(8.0 * M_PI * interval * static_cast<double>(i - 150));
  EXPECT_LT(jolt.error(jolt.smoothed()), 3.0 * jolt.error(jolt.measured));
}

TEST(PathSmoothing, KeepsTheMotionOfACameraThatStoodStillBefore) {
  // Standing still is smooth and exact; what is true of it must not be asked of the motion.
  for (const double share : {0.55, 0.8}) {
    Random random(9);
    Path path(600, 0.0);
    double before = 0.0, after = 0.0;
    const auto begin = static_cast<std::size_t>(share * 600.0);
    for (std::size_t i = 0; i < path.truth.size(); ++i) {
      const double time = i < begin ? 0.0 : interval * static_cast<double>(i - begin);
      path.truth[i] = Eigen::Vector3d(1.0, 0.5, 0.0) * 0.15 * (1.0 - std::cos(4.0 * time));
      const double deviation = i < begin ? 0.0003 : 0.003;
      path.measured[i] = path.truth[i] + deviation * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
    }
    const std::vector<Eigen::Vector3d> smoothed = path.smoothed();
    for (std::size_t i = begin; i < path.truth.size(); ++i) {
      before += (path.measured[i] - path.truth[i]).squaredNorm();
      after += (smoothed[i] - path.truth[i]).squaredNorm();
    }
    EXPECT_LT(after, 0.5 * before) << share;
  }
}

TEST(PathSmoothing, StandsStampsThatAreNearlyEqual) {
  Path path(300, 0.002);
  path.times[100] = path.times[99] + 1e-6;
  path.times[200] = path.times[199];
  EXPECT_LT(path.error(path.smoothed()), 0.7 * path.error(path.measured));
}

TEST(PathSmoothing, FollowsNeitherOutliersNorASecondOfWorseErrors) {
  Path path(300, 0.001);
  Random random(3);
  path.measured[50].x() += 0.1;
  for (std::size_t i = 150; i < 180; ++i) path.measured[i].y() += 0.02 * random.normal();
  const std::vector<Eigen::Vector3d> smoothed = path.smoothed();
  EXPECT_LT((smoothed[50] - path.truth[50]).norm(), 0.003);
  EXPECT_LT(path.error(smoothed), 0.6 * path.error(path.measured));
  EXPECT_LT((smoothed[140] - path.truth[140]).norm(), 0.002) << "the good ones are not drawn along";
}

TEST(PathSmoothing, DoesNotLinkTheSidesOfAGap) {
  Path path(200, 0.001);
  for (std::size_t i = 100; i < 200; ++i) {
    path.times[i] += 5.0;
    for (std::vector<Eigen::Vector3d>* positions : {&path.truth, &path.measured}) (*positions)[i].x() += 2.0;
  }
  const std::vector<Eigen::Vector3d> smoothed = path.smoothed();
  for (const std::size_t i : {98U, 99U, 100U, 101U}) EXPECT_LT((smoothed[i] - path.truth[i]).norm(), 0.003) << i;
}

TEST(PathSmoothing, LeavesWhatIsTooShort) {
  for (const int count : {0, 1, 2, 4}) {
    const Path path(count, 0.01);
    EXPECT_EQ(path.smoothed(), path.measured) << count;
  }
  const std::vector<double> times(10, 3.0);
  const std::vector<Eigen::Vector3d> measured(10, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(smooth_path(times, measured), measured);
}

TEST(PathSmoothing, ItsSystemIsTheDenseOne) {
  const Path path(12, 0.01);
  const std::size_t size = path.times.size();
  std::vector<double> times = path.times;
  for (std::size_t i = 7; i < size; ++i) times[i] += 1.4 * interval;  // a frame is missing
  std::vector<double> weights(size);
  for (std::size_t i = 0; i < size; ++i) weights[i] = 0.5 + 0.1 * static_cast<double>(i);
  constexpr double ratio = 0.3;

  // Integrals of white noise of unit density over a step (Anderson and Barfoot, equation 8), as a matrix of all states.
  const auto states = static_cast<Eigen::Index>(2 * size);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(states, states);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(states, 3);
  for (std::size_t i = 0; i < size; ++i) {
    const auto at = static_cast<Eigen::Index>(2 * i);
    information(at, at) += weights[i];
    right.row(at) = weights[i] * path.measured[i].transpose();
    if (i == 0) continue;
    const double step = (times[i] - times[i - 1]) / interval;
    Eigen::Matrix2d noise;
    noise << step * step * step / 3.0, step * step / 2.0, step * step / 2.0, step;
    Eigen::Matrix<double, 2, 4> residual;
    residual << -1.0, -step, 1.0, 0.0, 0.0, -1.0, 0.0, 1.0;
    information.block<4, 4>(at - 2, at - 2) += residual.transpose() * (ratio * noise).inverse() * residual;
  }
  const Eigen::MatrixXd covariance = information.inverse();

  std::vector<Eigen::Vector3d> smoothed(size);
  std::vector<double> leverage(size);
  detail::PathSystem(times).solve(ratio, weights, path.measured, smoothed, &leverage);
  for (std::size_t i = 0; i < size; ++i) {
    const auto at = static_cast<Eigen::Index>(2 * i);
    EXPECT_LT(((covariance * right).row(at).transpose() - smoothed[i]).norm(), 1e-8) << i;
    EXPECT_NEAR(leverage[i], covariance(at, at) * weights[i], 1e-8) << i;
  }
}

}  // namespace
}  // namespace holdfast::geometry
