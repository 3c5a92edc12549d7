// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <numbers>

#include "geometry/synthetic.hpp"
#include "holdfast/geometry/relative_pose.hpp"
#include "holdfast/geometry/upright_motion.hpp"

namespace holdfast::geometry {
namespace {

constexpr double pi = std::numbers::pi;

Eigen::Vector3d axis(Random& random) {
  return Eigen::Vector3d{random.normal(), random.normal(), random.normal()}.normalized();
}

TEST(So3, LogUndoesExpAtEveryAngle) {
  Random random(1);
  for (const double angle : {0.0, 1e-12, 1e-9, 1e-6, 1e-4, 0.01, 0.1, 1.0, 3.0, pi - 1e-3, pi - 1e-6, pi - 1e-9}) {
    const Eigen::Vector3d rotation = angle * axis(random);
    EXPECT_LT((log_so3(exp_so3(rotation)) - rotation).norm(), 1e-15 + 1e-14 * angle) << angle;
    EXPECT_LT((log_so3(Eigen::Matrix3d(exp_so3(rotation).toRotationMatrix())) - rotation).norm(), 1e-14) << angle;
  }
  // At pi both signs are right.
  const Eigen::Vector3d half_turn = pi * axis(random);
  const Eigen::Vector3d back = log_so3(Eigen::Matrix3d(exp_so3(half_turn).toRotationMatrix()));
  EXPECT_LT(std::min((back - half_turn).norm(), (back + half_turn).norm()), 1e-12);
  // Beyond it the short way round.
  EXPECT_NEAR(log_so3(exp_so3(Eigen::Vector3d(0, 0, 1.5 * pi))).z(), -0.5 * pi, 1e-12);
}

TEST(So3, ExpAgreesWithAngleAxis) {
  const Eigen::Vector3d rotation(0.3, -1.2, 0.5);
  const Eigen::AngleAxisd expected(rotation.norm(), rotation.normalized());
  EXPECT_LT((exp_so3(rotation).toRotationMatrix() - expected.toRotationMatrix()).norm(), 1e-14);
}

TEST(So3, JacobiansAgreeWithDifferences) {
  Random random(2);
  for (const double angle : {0.0, 1e-5, 0.05, 0.0999, 0.1001, 1.0, 2.5, 3.1}) {
    const Eigen::Vector3d rotation = angle * axis(random);
    const double h = 1e-6;
    Eigen::Matrix3d left, right;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d d = h * Eigen::Vector3d::Unit(i);
      const Eigen::Quaterniond plus = exp_so3(rotation + d), minus = exp_so3(rotation - d);
      left.col(i) = log_so3(plus * minus.inverse()) / (2 * h);
      right.col(i) = log_so3(minus.inverse() * plus) / (2 * h);
    }
    EXPECT_LT((left_jacobian_so3(rotation) - left).norm(), 1e-8) << angle;
    EXPECT_LT((left_jacobian_so3(-rotation) - right).norm(), 1e-8) << angle;
    const Eigen::Matrix3d one = left_jacobian_so3(rotation) * left_jacobian_inverse_so3(rotation);
    EXPECT_LT((one - Eigen::Matrix3d::Identity()).norm(), 1e-12) << angle;
  }
}

TEST(Se3, LogUndoesExpAtEveryAngle) {
  Random random(3);
  for (const double angle : {0.0, 1e-9, 1e-4, 0.05, 0.2, 1.0, 3.0, pi - 1e-4, pi - 1e-7}) {
    Vector6d tangent;
    tangent << axis(random), angle * axis(random);
    EXPECT_LT((log_se3(exp_se3(tangent)) - tangent).norm(), 1e-13) << angle;
  }
}

TEST(Se3, JacobiansAgreeWithDifferences) {
  Random random(4);
  for (const double angle : {0.0, 1e-3, 0.2999, 0.3001, 1.5, 3.0}) {
    Vector6d tangent;
    tangent << 2.0 * axis(random), angle * axis(random);
    const double h = 1e-6;
    Matrix6d left, right;
    for (int i = 0; i < 6; ++i) {
      const Vector6d d = h * Vector6d::Unit(i);
      const Eigen::Isometry3d plus = exp_se3(tangent + d), minus = exp_se3(tangent - d);
      left.col(i) = log_se3(plus * minus.inverse()) / (2 * h);
      right.col(i) = log_se3(minus.inverse() * plus) / (2 * h);
    }
    Matrix6d exact = Matrix6d::Zero();  // the left Jacobian itself (equation 179a)
    exact.topLeftCorner<3, 3>() = exact.bottomRightCorner<3, 3>() = left_jacobian_so3(tangent.tail<3>());
    exact.topRightCorner<3, 3>() = left_jacobian_coupling(tangent);
    EXPECT_LT((exact - left).norm(), 2e-8) << angle;
    const Matrix6d left_one = exact * left_jacobian_inverse_se3(tangent);
    const Matrix6d right_one = right * right_jacobian_inverse_se3(tangent);
    EXPECT_LT((left_one - Matrix6d::Identity()).norm(), 1e-11) << angle;
    EXPECT_LT((right_one - Matrix6d::Identity()).norm(), 2e-8) << angle;
  }
}

TEST(Se3, AdjointMovesAPerturbationToTheOtherSide) {
  Random random(5);
  const Eigen::Isometry3d motion = exp_se3(synthetic::tangent(random, 1.0, 0.7));
  const Vector6d d = synthetic::tangent(random, 0.3, 0.2);
  const Eigen::Isometry3d expected = motion * exp_se3(d);
  EXPECT_LT((expected.matrix() - (exp_se3(adjoint_se3(motion) * d) * motion).matrix()).norm(), 1e-13);
}

TEST(RelativePose, DerivativesAgreeWithDifferences) {
  Random random(6);
  for (const double turn : {0.0, 0.3, 1.5}) {
    const Eigen::Isometry3d from = exp_se3(synthetic::tangent(random, 1.0, 0.5));
    const Eigen::Isometry3d T_from_to = exp_se3(synthetic::tangent(random, 0.5, 0.3));
    const Eigen::Isometry3d to = exp_se3(synthetic::tangent(random, 0.5, turn)) * T_from_to.inverse() * from;
    const RelativePoseError error = relative_pose_error(T_from_to, from, to);
    EXPECT_EQ(error.residual, relative_pose_residual(T_from_to, from, to));
    EXPECT_LT(relative_pose_residual(T_from_to, from, T_from_to.inverse() * from).norm(), 1e-12);
    for (int i = 0; i < 6; ++i) {
      const Eigen::Isometry3d plus = exp_se3(1e-6 * Vector6d::Unit(i)), minus = plus.inverse();
      const Vector6d by_from =
          (relative_pose_residual(T_from_to, plus * from, to) - relative_pose_residual(T_from_to, minus * from, to)) /
          2e-6;
      const Vector6d by_to =
          (relative_pose_residual(T_from_to, from, plus * to) - relative_pose_residual(T_from_to, from, minus * to)) /
          2e-6;
      EXPECT_LT((error.by_from.col(i) - by_from).norm(), 1e-7) << turn << " column " << i;
      EXPECT_LT((error.by_to.col(i) - by_to).norm(), 1e-7) << turn << " column " << i;
    }
  }
}

TEST(UprightBasis, KeepsTheVerticalForAnyStep) {
  Random random(7);
  const Eigen::Vector3d vertical = Eigen::Vector3d(0.3, -0.2, 0.9).normalized();
  for (int trial = 0; trial < 5; ++trial) {
    const Eigen::Isometry3d pose = exp_se3(synthetic::tangent(random, 2.0, 2.0));
    const UprightBasis basis = upright_basis(pose.linear(), vertical);
    EXPECT_LT((basis.transpose() * basis - Eigen::Matrix4d::Identity()).norm(), 1e-14);
    const Eigen::Isometry3d moved = exp_se3(basis * Eigen::Vector4d(0.4, -1.2, 0.7, 2.5)) * pose;
    EXPECT_LT((moved.linear() * vertical - pose.linear() * vertical).norm(), 1e-14);
    const Eigen::Matrix3d turn = moved.linear().transpose() * pose.linear();  // of the camera in the world
    EXPECT_LT((turn - exp_so3(2.5 * vertical).toRotationMatrix()).norm(), 1e-13);
  }
}

TEST(UprightBasis, DerivativesAgreeWithDifferences) {
  Random random(8);
  const Eigen::Vector3d vertical = Eigen::Vector3d(-0.1, 0.97, 0.2).normalized();
  const Eigen::Isometry3d from = exp_se3(synthetic::tangent(random, 1.0, 0.8));
  const Eigen::Isometry3d T_from_to = exp_se3(synthetic::tangent(random, 0.5, 0.3));
  const Eigen::Isometry3d to = exp_se3(synthetic::tangent(random, 0.5, 0.4)) * T_from_to.inverse() * from;
  const UprightBasis of_from = upright_basis(from.linear(), vertical), of_to = upright_basis(to.linear(), vertical);
  const RelativePoseError error = relative_pose_error(T_from_to, from, to);
  const Eigen::Matrix<double, 6, 4> by_from = error.by_from * of_from, by_to = error.by_to * of_to;
  for (int i = 0; i < 4; ++i) {
    // In the world: a translation of the camera, and a turn about the vertical at its place.
    const auto moved = [&](const Eigen::Isometry3d& T_camera_world, double step) {
      Eigen::Isometry3d T_world_camera = T_camera_world.inverse();
      if (i < 3) T_world_camera.pretranslate(step * Eigen::Vector3d::Unit(i));
      if (i == 3) T_world_camera.linear() = exp_so3(step * vertical).toRotationMatrix() * T_world_camera.linear();
      return T_world_camera.inverse();
    };
    const Vector6d from_difference = relative_pose_residual(T_from_to, moved(from, 1e-6), to) -
                                     relative_pose_residual(T_from_to, moved(from, -1e-6), to);
    const Vector6d to_difference = relative_pose_residual(T_from_to, from, moved(to, 1e-6)) -
                                   relative_pose_residual(T_from_to, from, moved(to, -1e-6));
    EXPECT_LT((by_from.col(i) - from_difference / 2e-6).norm(), 1e-7) << i;
    EXPECT_LT((by_to.col(i) - to_difference / 2e-6).norm(), 1e-7) << i;
  }
}

}  // namespace
}  // namespace holdfast::geometry
