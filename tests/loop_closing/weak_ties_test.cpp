// SPDX-License-Identifier: BSD-3-Clause
#include "weak_ties.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "holdfast/core/imu.hpp"

namespace holdfast {
namespace {

constexpr std::uint32_t shared_points = 10;  ///< by both clusters, the second half of them wrongly

/// Two clusters of three keyframes at their true poses, with points of their own, few that both observe, and an
/// inertial factor over half a second between them.
class WeakTiesTest : public testing::Test {
 protected:
  WeakTiesTest() {
    problem.camera = &camera;
    for (int i = 0; i < 6; ++i) {
      Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
      T_world_camera.translation().x() = 0.02 * i;
      problem.poses.push_back({T_world_camera.inverse(), i == 0});
    }
    for (std::uint32_t i = 0; i < 40; ++i) {
      problem.points.emplace_back(0.05 * i - 1.0, 0.01 * i, 3.0);
      const std::uint32_t first = i < 20 ? 0 : 3;
      for (std::uint32_t pose = first; pose < first + 3; ++pose) observe(pose, i, 0.0F);
      if (i < shared_points) observe(4, i, i < shared_points / 2 ? 0.5F : 40.0F);
    }
    add_inertia();
  }
  void observe(std::uint32_t pose, std::uint32_t point, float error) {
    const Eigen::Vector3d seen = problem.poses[pose].T_camera_world * problem.points[point];
    BundleProblem::Observation observation{.pose = pose, .point = point};
    observation.x = static_cast<float>(camera.fx * seen.x() / seen.z() + camera.cx) + error;
    observation.y = static_cast<float>(camera.fy * seen.y() / seen.z() + camera.cy);
    observation.right_x = observation.x - static_cast<float>(camera.baseline * camera.fx / seen.z());
    problem.observations.push_back(observation);
  }
  void add_inertia() {
    std::vector<ImuSample> samples;
    for (int i = -1; i <= 101; ++i) samples.push_back({0.005 * i, Eigen::Vector3d::Zero(), {0, 0, standard_gravity}});
    problem.factors.motions = {{.pose = 2}, {.pose = 3}};
    problem.factors.inertial.push_back(
        {0, 1, geometry::preintegrate(samples, 0.0, 0.5, find_imu("bmi055")->noise, {}).value()});
  }

  const Camera camera = find_camera("tum_fr3").value();
  const std::vector<std::uint32_t> cluster{7, 7, 7, 2, 2, 2};
  BundleProblem problem;
  WeakTies ties;
};

TEST_F(WeakTiesTest, ThoseThatContradictInertiaAreRejected) {
  const std::size_t all = problem.observations.size();
  ties.take_out(problem, cluster, {});
  EXPECT_EQ(problem.observations.size(), all - shared_points);
  ties.put_back_agreeing(problem);
  EXPECT_EQ(problem.observations.size(), all - shared_points / 2);
  EXPECT_EQ(ties.add_rejected(problem), shared_points / 2);
  ASSERT_EQ(problem.observations.size(), all);
  for (const BundleProblem::Observation& observation : problem.observations)
    EXPECT_EQ(observation.outlier,
              observation.pose == 4 && observation.point >= shared_points / 2 && observation.point < shared_points)
        << observation.pose << " " << observation.point;
}

/// Right ties of a keyframe that stands much nearer to the points than their home, whose disparity says little there.
TEST_F(WeakTiesTest, TheDepthOfTheHomeMayBeWrongByItsDeviation) {
  problem.poses[4].T_camera_world = Eigen::Isometry3d(Eigen::Translation3d(-0.08, 0.0, -2.0));
  for (BundleProblem::Observation& observation : problem.observations) {
    if (observation.pose != 4 || observation.point >= shared_points) continue;
    const Eigen::Vector3d seen = problem.poses[4].T_camera_world * problem.points[observation.point];
    observation.x = static_cast<float>(camera.fx * seen.x() / seen.z() + camera.cx);
    observation.y = static_cast<float>(camera.fy * seen.y() / seen.z() + camera.cy);
    observation.right_x = observation.x - static_cast<float>(camera.baseline * camera.fx / seen.z());
  }
  for (std::uint32_t i = 0; i < shared_points; ++i)  // a quarter of a pixel of disparity at 3 m is 5 cm, at 1 m 5 px
    problem.points[i] += 1.5 * 9.0 / (camera.baseline * camera.fx) * problem.points[i].normalized();
  const std::size_t all = problem.observations.size();
  ties.take_out(problem, cluster, {});
  ASSERT_EQ(problem.observations.size(), all - shared_points);
  ties.put_back_agreeing(problem);
  EXPECT_EQ(problem.observations.size(), all);
}

/// One camera: the parallax within the cluster that mostly observes a point tells its depth. Points are 1 m too near.
TEST_F(WeakTiesTest, WithOneCameraTheParallaxTellsTheDepth) {
  for (BundleProblem::Observation& observation : problem.observations)
    observation.right_x = std::numeric_limits<float>::quiet_NaN();
  problem.poses[4].T_camera_world = Eigen::Isometry3d(Eigen::Translation3d(-0.28, 0.0, 0.0));
  for (BundleProblem::Observation& observation : problem.observations)
    if (observation.pose == 4 && observation.point < shared_points) {
      const Eigen::Vector3d in_camera = problem.poses[4].T_camera_world * problem.points[observation.point];
      observation.x = static_cast<float>(camera.fx * in_camera.x() / in_camera.z() + camera.cx);
    }
  for (std::uint32_t i = 0; i < shared_points; ++i) problem.points[i] -= problem.points[i].normalized();
  const BundleProblem seen = problem;
  for (const double step : {0.005, 0.05}) {  // [m]
    problem = seen;
    for (int i = 0; i < 3; ++i) problem.poses[i].T_camera_world.translation().x() = -step * i;
    const std::size_t all = problem.observations.size();
    ties.take_out(problem, cluster, {});
    ASSERT_EQ(problem.observations.size(), all - shared_points);
    ties.put_back_agreeing(problem);
    EXPECT_EQ(problem.observations.size(), step < 0.01 ? all : all - shared_points) << step;
  }
}

TEST_F(WeakTiesTest, AllCanBePutBack) {
  const std::size_t all = problem.observations.size();
  ties.take_out(problem, cluster, {});
  ties.put_back_all(problem);
  EXPECT_EQ(problem.observations.size(), all);
}

TEST_F(WeakTiesTest, InertiaThatSaysNothingDecidesNothing) {
  const std::size_t all = problem.observations.size();
  MapInertia uncertain;
  uncertain.accelerometer_deviation = 2.0;
  ties.take_out(problem, cluster, uncertain);
  EXPECT_TRUE(ties.empty());
  problem.factors.inertial.clear();
  ties.take_out(problem, cluster, {});
  EXPECT_TRUE(ties.empty());
  ties.take_out(problem, std::vector<std::uint32_t>(6, 0), {});
  EXPECT_TRUE(ties.empty());
  EXPECT_EQ(problem.observations.size(), all);
}

}  // namespace
}  // namespace holdfast
