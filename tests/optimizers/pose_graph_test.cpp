// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "both_optimizers.hpp"
#include "geometry/synthetic.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast {
namespace {

/// What every optimizer must do; the parameter is its name.
class PoseGraph : public testing::TestWithParam<std::string> {
 protected:
  static std::unique_ptr<Optimizer> make() { return make_optimizer(GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(Optimizers, PoseGraph, testing::Values("ceres", "schur"),
                         [](const auto& each) { return each.param; });

struct Loop {
  PoseGraphProblem problem;
  std::vector<Eigen::Isometry3d> truth;

  /// A walk round a circle of two metres; every step drifts by the same motion, and one edge closes the loop.
  explicit Loop(int count) {
    geometry::Vector6d drift;
    drift << 0.01, 0.005, -0.004, 0.002, 0.006, -0.003;
    for (int i = 0; i < count; ++i) {
      Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
      const double angle = 2.0 * std::numbers::pi * i / count;
      T_world_camera.linear() = geometry::exp_so3(Eigen::Vector3d(0, angle, 0)).toRotationMatrix();
      T_world_camera.translation() = 2.0 * Eigen::Vector3d(std::sin(angle), 0.0, std::cos(angle));
      truth.push_back(T_world_camera.inverse());
    }
    problem.nodes.push_back({truth[0], true});
    for (int i = 1; i < count; ++i) {
      const Eigen::Isometry3d step = truth[i] * truth[i - 1].inverse();
      problem.nodes.push_back({geometry::exp_se3(drift) * step * problem.nodes[i - 1].T_camera_world, false});
      problem.edges.push_back({static_cast<std::uint32_t>(i - 1), static_cast<std::uint32_t>(i),
                               problem.nodes[i].T_camera_world * problem.nodes[i - 1].T_camera_world.inverse(), 1.0});
    }
    problem.edges.push_back({static_cast<std::uint32_t>(count - 1), 0, truth[0] * truth[count - 1].inverse(), 100.0});
  }
  double largest_error() const {
    double largest = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i)
      largest = std::max(largest, synthetic::distance(problem.nodes[i].T_camera_world, truth[i]));
    return largest;
  }
};

TEST_P(PoseGraph, ClosesALoop) {
  Loop loop(60);
  const double before = loop.largest_error();
  const GraphSummary summary = make()->optimize_pose_graph(loop.problem);
  ASSERT_TRUE(summary.usable);
  EXPECT_LT(summary.final_cost, 0.1 * summary.initial_cost);
  EXPECT_LT(loop.largest_error(), 0.35 * before);
  EXPECT_EQ(loop.problem.nodes[0].T_camera_world.matrix(), loop.truth[0].matrix());
  const Eigen::Isometry3d closed =
      loop.problem.nodes[0].T_camera_world * loop.problem.nodes[59].T_camera_world.inverse();
  EXPECT_LT(synthetic::distance(closed, loop.problem.edges.back().T_to_from), 0.01);
}

TEST_P(PoseGraph, IsExactWhereTheEdgesAgree) {
  Loop loop(40);
  for (PoseGraphProblem::Edge& edge : loop.problem.edges)
    edge.T_to_from = loop.truth[edge.to] * loop.truth[edge.from].inverse();
  loop.problem.iterations = 50;
  ASSERT_TRUE(make()->optimize_pose_graph(loop.problem).usable);
  EXPECT_LT(loop.largest_error(), 1e-5);
}

TEST_P(PoseGraph, SameBytesEveryTime) {
  Loop a(30), b(30);
  make()->optimize_pose_graph(a.problem);
  make()->optimize_pose_graph(b.problem);
  for (std::size_t i = 0; i < a.truth.size(); ++i)
    EXPECT_EQ(a.problem.nodes[i].T_camera_world.matrix(), b.problem.nodes[i].T_camera_world.matrix());
}

TEST_P(PoseGraph, FindsPosesAndScalesOfOneCamera) {
  // The unit of length shrinks along the walk, as that of one camera does; the last edge says by how much.
  constexpr int count = 60;
  Loop loop(count);
  const auto unit = [](int i) { return std::exp(-0.3 * i / count); };
  const auto step = [&](int i) {
    Eigen::Isometry3d motion = loop.truth[i] * loop.truth[i - 1].inverse();
    motion.translation() *= unit(i);
    return motion;
  };
  for (int i = 1; i < count; ++i) {
    loop.problem.nodes[i].T_camera_world = step(i) * loop.problem.nodes[i - 1].T_camera_world;
    loop.problem.edges[i - 1].T_to_from = step(i);
  }
  loop.problem.edges.back().scale = 1.0 / unit(count - 1);
  const double before = loop.largest_error();
  ASSERT_TRUE(make()->optimize_similarity_graph(loop.problem).usable);
  EXPECT_GT(before, 0.3);
  EXPECT_LT(loop.largest_error(), 0.02);
  for (int i = 0; i < count; ++i) EXPECT_NEAR(loop.problem.nodes[i].scale * unit(i), 1.0, 0.01) << i;
}

TEST_P(PoseGraph, WithoutScalesBothGraphsAreTheSame) {
  Loop rigid(30), similar(30);
  ASSERT_TRUE(make()->optimize_pose_graph(rigid.problem).usable);
  ASSERT_TRUE(make()->optimize_similarity_graph(similar.problem).usable);
  for (std::size_t i = 0; i < rigid.truth.size(); ++i) {
    EXPECT_LT(synthetic::distance(rigid.problem.nodes[i].T_camera_world, similar.problem.nodes[i].T_camera_world),
              1e-9);
    EXPECT_NEAR(similar.problem.nodes[i].scale, 1.0, 1e-12);
  }
}

/// The largest angle by which the vertical of a node differs from the truth [rad].
double largest_tilt(const Loop& loop, const Eigen::Vector3d& vertical) {
  double largest = 0.0;
  for (std::size_t i = 0; i < loop.truth.size(); ++i)
    largest = std::max(
        largest,
        (loop.problem.nodes[i].T_camera_world.linear() * vertical).cross(loop.truth[i].linear() * vertical).norm());
  return largest;
}

/// The path drifts in position and yaw alone, as one with inertial measurements does; the loop is measured with a tilt.
Loop tilted_loop() {
  constexpr int count = 60;
  Loop loop(count);
  geometry::Vector6d drift;
  drift << 0.01, 0.005, -0.004, 0.0, 0.006, 0.0;
  for (int i = 1; i < count; ++i) {
    loop.problem.edges[i - 1].T_to_from = geometry::exp_se3(drift) * loop.truth[i] * loop.truth[i - 1].inverse();
    loop.problem.nodes[i].T_camera_world =
        loop.problem.edges[i - 1].T_to_from * loop.problem.nodes[i - 1].T_camera_world;
  }
  Eigen::Isometry3d& closing = loop.problem.edges.back().T_to_from;
  closing.linear() = closing.linear() * geometry::exp_so3(Eigen::Vector3d(0.06, 0, 0.03)).toRotationMatrix();
  return loop;
}

TEST_P(PoseGraph, WithAVerticalNothingTilts) {
  const Eigen::Vector3d down(0.0, 9.81, 0.0);
  Loop six = tilted_loop(), four = tilted_loop();
  ASSERT_LT(largest_tilt(six, down.normalized()), 1e-12);
  const double before = six.largest_error();
  ASSERT_TRUE(make()->keeps_vertical());
  ASSERT_TRUE(make()->optimize_pose_graph(six.problem).usable);
  four.problem.vertical = down;
  ASSERT_TRUE(make()->optimize_pose_graph(four.problem).usable);
  EXPECT_GT(largest_tilt(six, down.normalized()), 0.02);
  EXPECT_LT(largest_tilt(four, down.normalized()), 1e-12);
  EXPECT_LT(four.largest_error(), 0.35 * before);
  EXPECT_EQ(four.problem.nodes[0].T_camera_world.matrix(), four.truth[0].matrix());
}

TEST_P(PoseGraph, WithAVerticalAndScales) {
  const Eigen::Vector3d down = Eigen::Vector3d::UnitY();
  Loop loop = tilted_loop();
  loop.problem.vertical = down;
  loop.problem.edges.back().scale = 1.3;
  ASSERT_TRUE(make()->optimize_similarity_graph(loop.problem).usable);
  EXPECT_LT(largest_tilt(loop, down), 1e-12);
  EXPECT_GT(loop.problem.nodes[59].scale, 1.1);
}

TEST_P(PoseGraph, RefusesAVerticalWithoutADirection) {
  for (const double length : {0.0, std::numeric_limits<double>::quiet_NaN()}) {
    Loop loop = tilted_loop();
    const Eigen::Matrix4d before = loop.problem.nodes[5].T_camera_world.matrix();
    loop.problem.vertical = Eigen::Vector3d::Constant(length);
    EXPECT_FALSE(make()->optimize_pose_graph(loop.problem).usable);
    EXPECT_EQ(loop.problem.nodes[5].T_camera_world.matrix(), before);
  }
}

TEST_P(PoseGraph, RefusesWhatCannotBeSolved) {
  Loop loose(10);
  loose.problem.nodes[0].fixed = false;
  const Eigen::Matrix4d before = loose.problem.nodes[5].T_camera_world.matrix();
  EXPECT_FALSE(make()->optimize_pose_graph(loose.problem).usable) << "no gauge";
  EXPECT_EQ(loose.problem.nodes[5].T_camera_world.matrix(), before);
  PoseGraphProblem empty;
  EXPECT_FALSE(make()->optimize_pose_graph(empty).usable);
  Loop broken(10);
  broken.problem.edges[3].to = 10;
  EXPECT_THROW(make()->optimize_pose_graph(broken.problem), CheckError);
  EXPECT_THROW(make()->optimize_similarity_graph(broken.problem), CheckError);
  Loop unknown(10);
  unknown.problem.edges.back().scale = 0.0;
  EXPECT_FALSE(make()->optimize_similarity_graph(unknown.problem).usable);
}

}  // namespace
}  // namespace holdfast
