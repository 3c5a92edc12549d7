// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "ceres/observation_cost.hpp"
#include "ceres/relative_pose_cost.hpp"
#include "geometry/synthetic.hpp"

namespace holdfast::ceres_plugin {
namespace {

const Camera camera = synthetic::camera();

PoseState turned_state() {
  PoseState state;
  Random random(1);
  state.set(geometry::exp_se3(synthetic::tangent(random, 0.3, 0.4)));
  const double moved[6] = {0.1, -0.2, 0.3, 0.4, -0.3, 0.2};  // well away from where it was set
  std::copy_n(moved, 6, state.parameters);
  state.update();
  return state;
}

template <int rows>
void check_observation(double threshold) {
  PoseState state = turned_state();
  Eigen::Vector3d point = state.T_camera_world().inverse() * Eigen::Vector3d(0.3, -0.2, 1.7);
  const Measurement measurement{.x = 400.0,
                                .y = 200.0,
                                .disparity = 20.0,
                                .scale = 0.7,
                                .disparity_scale = 0.9,
                                .disparity_threshold = threshold};
  const FreePoseCost<rows> cost(camera, measurement, state);
  const double* blocks[2] = {state.parameters, point.data()};
  Eigen::Matrix<double, rows, 1> residual, plus, minus;
  Eigen::Matrix<double, rows, 6, Eigen::RowMajor> by_pose;
  Eigen::Matrix<double, rows, 3, Eigen::RowMajor> by_point;
  double* jacobians[2] = {by_pose.data(), by_point.data()};
  ASSERT_TRUE(cost.Evaluate(blocks, residual.data(), jacobians));
  const double h = 1e-6;
  const auto difference = [&](double& value) {
    const double before = value;
    value = before + h, state.update(), cost.Evaluate(blocks, plus.data(), nullptr);
    value = before - h, state.update(), cost.Evaluate(blocks, minus.data(), nullptr);
    value = before, state.update();
    return Eigen::Matrix<double, rows, 1>((plus - minus) / (2 * h));
  };
  for (int i = 0; i < 6; ++i) EXPECT_LT((by_pose.col(i) - difference(state.parameters[i])).norm(), 1e-5) << i;
  for (int i = 0; i < 3; ++i) EXPECT_LT((by_point.col(i) - difference(point[i])).norm(), 1e-5) << i;
  const Eigen::Vector3d p = state.T_camera_world() * point;
  EXPECT_NEAR(residual[0], 0.7 * (camera.project(p).x() - 400.0), 1e-9);
  EXPECT_NEAR(residual[1], 0.7 * (camera.project(p).y() - 200.0), 1e-9);
  if constexpr (rows == 3) {
    const double plain = 0.9 * (camera.fx * camera.baseline / p.z() - 20.0), size = std::abs(plain);
    const double cost = size <= threshold ? plain * plain : 2.0 * threshold * size - threshold * threshold;
    EXPECT_NEAR(residual[2] * residual[2], cost, 1e-9);
    EXPECT_EQ(std::signbit(residual[2]), std::signbit(plain));
  }
}

TEST(ObservationCost, JacobiansAgreeWithDifferences) {
  check_observation<2>(1.0);
  check_observation<3>(1e3);
  check_observation<3>(1.0);  // far beyond: Huber's cost is linear
}

TEST(ObservationCost, BehindTheCameraIsDearAndFlat) {
  const PoseState state = turned_state();
  const Eigen::Vector3d point = state.T_camera_world().inverse() * Eigen::Vector3d(0.3, -0.2, -1.0);
  const Measurement measurement{.x = 400.0, .y = 200.0, .disparity = 20.0};
  const FreePoseCost<3> cost(camera, measurement, state);
  const double* blocks[2] = {state.parameters, point.data()};
  double residual[3], by_pose[18], by_point[9];
  double* jacobians[2] = {by_pose, by_point};
  ASSERT_TRUE(cost.Evaluate(blocks, residual, jacobians));
  EXPECT_GT(residual[0] * residual[0], 100.0);
  EXPECT_EQ(*std::max_element(by_pose, by_pose + 18), 0.0);
  EXPECT_EQ(*std::max_element(by_point, by_point + 9), 0.0);
}

/// The group of fixed observations must offer the solver what its observations one by one would.
TEST(FixedPosesCost, IsTheSameAsRowByRow) {
  const PoseState state = turned_state();
  Eigen::Vector3d point = state.T_camera_world().inverse() * Eigen::Vector3d(0.3, -0.2, 1.7);
  const Eigen::Vector3d p = state.T_camera_world() * point;
  const Eigen::Vector2d pixel = camera.project(p);
  const double disparity = camera.fx * camera.baseline / p.z();
  for (const bool is_robust : {true, false}) {
    for (const int count : {1, 3}) {  // one observation without depth: singular
      std::vector<FixedObservation> observations;
      for (int i = 0; i < count; ++i)  // the second one is beyond the limit
        observations.push_back(
            {{pixel.x() + 1.0 + 9.0 * (i % 2), pixel.y() - 0.5, disparity + 0.3}, &state, i ? 7.815 : 5.991, i != 0});
      const FixedPosesCost cost(camera, observations, is_robust);
      Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
      Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
      double sum = 0.0;
      for (const FixedObservation& o : observations) {
        double residual[3] = {0, 0, 0}, jacobian[9] = {}, rho[3];
        if (o.has_right)
          evaluate_observation<3>(camera, o.measurement, state, point.data(),
                                  {.residual = residual, .point_jacobian = jacobian});
        else
          evaluate_observation<2>(camera, o.measurement, state, point.data(),
                                  {.residual = residual, .point_jacobian = jacobian});
        const Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> j(jacobian);
        const Eigen::Vector3d r = Eigen::Vector3d::Map(residual);
        SwitchableHuber(o.limit, is_robust).Evaluate(r.squaredNorm(), rho);
        hessian += rho[1] * j.transpose() * j;
        gradient += rho[1] * j.transpose() * r;
        sum += rho[0];
      }
      const double* blocks[1] = {point.data()};
      Eigen::Vector4d residual;
      Eigen::Matrix<double, 4, 3, Eigen::RowMajor> jacobian;
      double* jacobians[1] = {jacobian.data()};
      cost.Evaluate(blocks, residual.data(), jacobians);
      EXPECT_NEAR(residual.squaredNorm(), sum, 1e-9 * sum);
      EXPECT_LT((jacobian.transpose() * jacobian - hessian).norm(), 1e-6 * hessian.norm()) << count;
      EXPECT_LT((jacobian.transpose() * residual - gradient).norm(), 1e-6 * gradient.norm()) << count;
      cost.Evaluate(blocks, residual.data(), nullptr);
      EXPECT_NEAR(residual.squaredNorm(), sum, 1e-9 * sum);
    }
  }
}

TEST(SwitchableHuber, DerivativesAgreeWithDifferences) {
  const bool is_robust = true;
  for (const double squared : {1.0, 5.9, 6.1, 80.0}) {
    double rho[3], plus[3], minus[3];
    const SwitchableHuber loss(5.991, is_robust);
    loss.Evaluate(squared, rho);
    loss.Evaluate(squared + 1e-5, plus);
    loss.Evaluate(squared - 1e-5, minus);
    EXPECT_NEAR(rho[1], (plus[0] - minus[0]) / 2e-5, 1e-8);
    EXPECT_NEAR(rho[2], (plus[1] - minus[1]) / 2e-5, 1e-8);
  }
}

TEST(RelativePoseCost, JacobiansAgreeWithDifferences) {
  Random random(2);
  const LeftPerturbation manifold;
  for (const double turn : {0.0, 0.3, 1.5}) {
    const Eigen::Isometry3d from = geometry::exp_se3(synthetic::tangent(random, 1.0, 0.5));
    const Eigen::Isometry3d between = geometry::exp_se3(synthetic::tangent(random, 0.5, 0.3));
    const Eigen::Isometry3d to = geometry::exp_se3(synthetic::tangent(random, 0.5, turn)) * between * from;
    double blocks[2][7];
    store(from, blocks[0]);
    store(to, blocks[1]);
    const RelativePoseCost cost(between, 1.3);
    const double* parameters[2] = {blocks[0], blocks[1]};
    geometry::Vector6d residual, plus, minus;
    Eigen::Matrix<double, 6, 7, Eigen::RowMajor> by_from, by_to;
    double* jacobians[2] = {by_from.data(), by_to.data()};
    cost.Evaluate(parameters, residual.data(), jacobians);
    const geometry::Vector6d expected = 1.3 * geometry::log_se3(between.inverse() * to * from.inverse());
    EXPECT_LT((residual - expected).norm(), 1e-12);
    for (int block = 0; block < 2; ++block) {
      for (int i = 0; i < 6; ++i) {
        double moved[7];
        const double* moved_parameters[2] = {parameters[0], parameters[1]};
        moved_parameters[block] = moved;
        const geometry::Vector6d d = 1e-6 * geometry::Vector6d::Unit(i), back = -d;
        manifold.Plus(parameters[block], d.data(), moved);
        cost.Evaluate(moved_parameters, plus.data(), nullptr);
        manifold.Plus(parameters[block], back.data(), moved);
        cost.Evaluate(moved_parameters, minus.data(), nullptr);
        const auto& jacobian = block == 0 ? by_from : by_to;
        EXPECT_LT((jacobian.col(i) - (plus - minus) / 2e-6).norm(), 1e-7) << "block " << block << " column " << i;
      }
    }
    EXPECT_EQ(by_from.col(6).norm() + by_to.col(6).norm(), 0.0);
  }
}

}  // namespace
}  // namespace holdfast::ceres_plugin
