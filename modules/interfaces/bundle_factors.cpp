// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/interfaces/bundle_factors.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "holdfast/core/check.hpp"
#include "holdfast/geometry/relative_pose.hpp"
#include "holdfast/interfaces/optimizer.hpp"

namespace holdfast {

namespace {

using Vector9d = Eigen::Matrix<double, 9, 1>;

Vector9d numbers_of(const Eigen::Vector3d& velocity, const ImuBias& bias) {
  Vector9d numbers;
  numbers << velocity, bias.gyroscope, bias.accelerometer;
  return numbers;
}

/// The state of the body at a camera pose.
geometry::InertialState body_state(const Eigen::Isometry3d& T_camera_world, const Vector9d& motion,
                                   const Eigen::Isometry3d& T_camera_body, double scale) {
  geometry::InertialState state;
  Eigen::Isometry3d T_world_camera = T_camera_world.inverse();
  T_world_camera.translation() *= scale;
  state.T_world_body = T_world_camera * T_camera_body;
  state.velocity = motion.head<3>();
  state.bias = {motion.segment<3>(3), motion.tail<3>()};
  return state;
}

/// Derivative of position and rotation of the body, perturbed as in inertial_state.hpp, by a left perturbation of
/// T_camera_world.
geometry::Matrix6d body_by_pose(const Eigen::Isometry3d& T_camera_world, const Eigen::Isometry3d& T_camera_body,
                                double scale) {
  const Eigen::Matrix3d R_world_camera = T_camera_world.linear().transpose();
  geometry::Matrix6d result = geometry::Matrix6d::Zero();
  result.topLeftCorner<3, 3>() = -scale * R_world_camera;
  result.topRightCorner<3, 3>() = R_world_camera * geometry::hat(T_camera_body.translation());
  result.bottomRightCorner<3, 3>() = -T_camera_body.linear().transpose();
  return result;
}

/// root^T * root = information, which may be singular; empty if it is not positive or not finite.
Eigen::MatrixXd root_of(const Eigen::Ref<const Eigen::MatrixXd>& information) {
  if (!information.allFinite()) return {};
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(information);
  const double largest = solver.eigenvalues().maxCoeff();
  if (!(largest > 0.0) || solver.eigenvalues().minCoeff() < -1e-9 * largest) return {};
  return solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() * solver.eigenvectors().transpose();
}

}  // namespace

FactorEvaluation::FactorEvaluation(const BundleProblem& problem) : problem_(problem), given_(problem.factors) {
  motion_moves_.assign(given_.motions.size(), 0);
  const Eigen::Vector3d down = given_.gravity.normalized();
  tangent_.col(0) = down.unitOrthogonal();
  tangent_.col(1) = down.cross(tangent_.col(0));
  const auto count = [](const auto& list) { return static_cast<std::uint32_t>(list.size()); };
  if (!given_.empty()) check_states();
  for (std::uint32_t i = 0; i < count(given_.inertial); ++i) add_inertial(i);
  for (std::uint32_t i = 0; i < count(given_.relative_poses); ++i) add_relative_pose(i);
  for (std::uint32_t i = 0; i < count(given_.pose_priors); ++i) add_pose_prior(i);
  for (std::uint32_t i = 0; i < count(given_.motion_priors); ++i) add_motion_prior(i);
}

void FactorEvaluation::check_states() {
  for (const BundleFactors::Motion& motion : given_.motions) {
    HOLDFAST_CHECK(motion.pose < problem_.poses.size(),
                   "a motion of pose " << motion.pose << " of " << problem_.poses.size());
    is_finite_ = is_finite_ && numbers_of(motion.velocity, motion.bias).allFinite();
  }
  is_finite_ = is_finite_ && given_.gravity.allFinite() && given_.gravity.norm() > 0.0 && given_.scale > 0.0 &&
               std::isfinite(given_.scale) && given_.T_body_camera.matrix().allFinite();
}

void FactorEvaluation::add_inertial(std::uint32_t index) {
  const BundleFactors::Inertial& inertial = given_.inertial[index];
  const std::size_t count = given_.motions.size();
  HOLDFAST_CHECK(
      inertial.first < count && inertial.second < count && inertial.first != inertial.second,
      "inertial factor " << index << " from motion " << inertial.first << " to " << inertial.second << " of " << count);
  Factor factor{.kind = FactorKind::inertial,
                .index = index,
                .poses = {given_.motions[inertial.first].pose, given_.motions[inertial.second].pose},
                .motions = {inertial.first, inertial.second},
                .has_world = true,
                .rows = 15,
                .root = {}};
  const geometry::Matrix15d& covariance = inertial.measured.covariance();
  const Eigen::LLT<geometry::Matrix15d> cholesky(covariance);
  const bool usable = covariance.allFinite() && cholesky.info() == Eigen::Success;
  add(factor, usable ? Eigen::MatrixXd(cholesky.matrixL().solve(geometry::Matrix15d::Identity())) : Eigen::MatrixXd());
}

void FactorEvaluation::add_relative_pose(std::uint32_t index) {
  const BundleFactors::RelativePose& relative = given_.relative_poses[index];
  HOLDFAST_CHECK(relative.from != relative.to, "relative pose " << index << " from pose " << relative.from << " to it");
  is_finite_ = is_finite_ && relative.T_to_from.matrix().allFinite();
  add({.kind = FactorKind::relative_pose, .index = index, .poses = {relative.from, relative.to}, .rows = 6, .root = {}},
      root_of(relative.information));
}

void FactorEvaluation::add_pose_prior(std::uint32_t index) {
  const BundleFactors::PosePrior& prior = given_.pose_priors[index];
  is_finite_ = is_finite_ && prior.T_camera_world.matrix().allFinite();
  add({.kind = FactorKind::prior, .index = index, .poses = {prior.pose, none}, .rows = 6, .root = {}},
      root_of(prior.information));
}

void FactorEvaluation::add_motion_prior(std::uint32_t index) {
  const BundleFactors::MotionPrior& prior = given_.motion_priors[index];
  HOLDFAST_CHECK(prior.motion < given_.motions.size(),
                 "prior " << index << " of motion " << prior.motion << " of " << given_.motions.size());
  is_finite_ = is_finite_ && numbers_of(prior.velocity, prior.bias).allFinite();
  add({.kind = FactorKind::prior, .index = index, .motions = {prior.motion, none}, .rows = 9, .root = {}},
      root_of(prior.information));
}

void FactorEvaluation::add(Factor factor, const Eigen::MatrixXd& root) {
  is_finite_ = is_finite_ && root.size() > 0 && root.allFinite();
  bool counts = false;
  for (const std::uint32_t pose : factor.poses) {
    if (pose == none) continue;
    HOLDFAST_CHECK(pose < problem_.poses.size(), "a factor of pose " << pose << " of " << problem_.poses.size());
    counts = counts || !problem_.poses[pose].fixed;
    is_finite_ = is_finite_ && problem_.poses[pose].T_camera_world.matrix().allFinite();
  }
  for (const std::uint32_t motion : factor.motions)
    counts = counts || (motion != none && !given_.motions[motion].fixed);
  if (!is_finite_ || !counts) return;
  for (const std::uint32_t motion : factor.motions)
    if (motion != none && !given_.motions[motion].fixed) motion_moves_[motion] = 1;
  factor.root.setZero();
  factor.root.topLeftCorner(factor.rows, factor.rows) = root;
  factors_.push_back(factor);
}

std::array<bool, 3> FactorEvaluation::world_moves() const {
  bool is_used = false;
  for (const Factor& factor : factors_) is_used = is_used || factor.has_world;
  const bool tilts = is_used && !given_.gravity_fixed;
  return {tilts, tilts, is_used && !given_.scale_fixed};
}

FactorEvaluation::States FactorEvaluation::states() const {
  States states;
  for (const BundleProblem::Pose& pose : problem_.poses) states.poses.push_back(pose.T_camera_world);
  for (const BundleFactors::Motion& motion : given_.motions)
    states.motions.push_back(numbers_of(motion.velocity, motion.bias));
  return states;
}

Eigen::Vector3d FactorEvaluation::gravity_at(const Eigen::Vector3d& world) const {
  return geometry::exp_so3(tangent_ * world.head<2>()) * given_.gravity;
}

double FactorEvaluation::scale_at(const Eigen::Vector3d& world) const { return given_.scale * std::exp(world[2]); }

Eigen::Matrix<double, 3, 2> FactorEvaluation::tilts_at(const Eigen::Vector3d& world) const {
  const Eigen::Vector3d turn = tangent_ * world.head<2>();
  return -geometry::hat(gravity_at(world)) * geometry::left_jacobian_so3(turn) * tangent_;
}

void FactorEvaluation::evaluate(const Factor& factor, const States& states, bool with_derivatives,
                                FactorError& error) const {
  error.rows = factor.rows;
  if (factor.kind == FactorKind::inertial) {
    evaluate_inertial(factor, states, with_derivatives, error);
  } else if (factor.kind == FactorKind::relative_pose) {
    const auto result = geometry::relative_pose_error(given_.relative_poses[factor.index].T_to_from.inverse(),
                                                      states.poses[factor.poses[0]], states.poses[factor.poses[1]]);
    error.residual.head<6>() = result.residual;
    error.by_pose[0].topRows<6>() = result.by_from;
    error.by_pose[1].topRows<6>() = result.by_to;
  } else if (factor.poses[0] != none) {
    const Eigen::Isometry3d& prior = given_.pose_priors[factor.index].T_camera_world;
    const geometry::Vector6d residual = geometry::log_se3(states.poses[factor.poses[0]] * prior.inverse());
    error.residual.head<6>() = residual;
    error.by_pose[0].topRows<6>() = geometry::left_jacobian_inverse_se3(residual);
  } else {
    const BundleFactors::MotionPrior& prior = given_.motion_priors[factor.index];
    error.residual.head<9>() = states.motions[factor.motions[0]] - numbers_of(prior.velocity, prior.bias);
    error.by_motion[0].topRows<9>().setIdentity();
  }
  const int rows = factor.rows;
  const auto whiten = [&](auto& block) {
    block.topRows(rows) = (factor.root.topLeftCorner(rows, rows) * block.topRows(rows)).eval();
  };
  whiten(error.residual);
  if (!with_derivatives) return;
  for (std::size_t i = 0; i < 2; ++i) {
    if (factor.poses[i] != none) whiten(error.by_pose[i]);
    if (factor.motions[i] != none) whiten(error.by_motion[i]);
  }
  if (factor.has_world) whiten(error.by_world);
}

void FactorEvaluation::evaluate_inertial(const Factor& factor, const States& states, bool with_derivatives,
                                         FactorError& error) const {
  const Eigen::Isometry3d T_camera_body = given_.T_body_camera.inverse();
  const double scale = scale_at(states.world);
  const auto state = [&](std::size_t i) {
    return body_state(states.poses[factor.poses[i]], states.motions[factor.motions[i]], T_camera_body, scale);
  };
  geometry::InertialJacobians jacobians;
  error.residual = given_.inertial[factor.index].measured.residual(state(0), state(1), gravity_at(states.world),
                                                                   with_derivatives ? &jacobians : nullptr);
  if (with_derivatives) derive_inertial(factor, states, jacobians, error);
}

void FactorEvaluation::derive_inertial(const Factor& factor, const States& states,
                                       const geometry::InertialJacobians& jacobians, FactorError& error) const {
  const Eigen::Isometry3d T_camera_body = given_.T_body_camera.inverse();
  const double scale = scale_at(states.world);
  error.by_world.leftCols<2>() = jacobians.gravity * tilts_at(states.world);
  error.by_world.col(2).setZero();
  for (std::size_t i = 0; i < 2; ++i) {
    const geometry::Matrix15d& by_state = i == 0 ? jacobians.first : jacobians.second;
    const Eigen::Isometry3d& T_camera_world = states.poses[factor.poses[i]];
    error.by_pose[i] = by_state.leftCols<6>() * body_by_pose(T_camera_world, T_camera_body, scale);
    error.by_motion[i] = by_state.rightCols<9>();
    error.by_world.col(2) += by_state.leftCols<3>() * (scale * T_camera_world.inverse().translation());
  }
}

double FactorEvaluation::cost(const States& states) const {
  double cost = 0.0;
  FactorError error;
  for (const Factor& factor : factors_) {
    evaluate(factor, states, false, error);
    cost += 0.5 * error.residual.head(error.rows).squaredNorm();
  }
  return cost;
}

void FactorEvaluation::write(const States& states, BundleProblem& problem) const {
  BundleFactors& factors = problem.factors;
  for (std::size_t i = 0; i < states.motions.size(); ++i) {
    if (!motion_moves(i)) continue;
    factors.motions[i].velocity = states.motions[i].head<3>();
    factors.motions[i].bias = {states.motions[i].segment<3>(3), states.motions[i].tail<3>()};
  }
  const std::array<bool, 3> moves = world_moves();
  const Eigen::Vector3d gravity = gravity_at(states.world);
  const double scale = scale_at(states.world);
  if (moves[0]) factors.gravity = gravity;
  if (moves[2]) factors.scale = scale;
}

}  // namespace holdfast
