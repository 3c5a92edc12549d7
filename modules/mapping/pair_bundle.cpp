// SPDX-License-Identifier: BSD-3-Clause
#include "pair_bundle.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "holdfast/geometry/se3.hpp"
#include "holdfast/geometry/so3.hpp"

namespace holdfast {

namespace {

constexpr double min_depth = 0.05;             // m
constexpr double disparity_sigma = 0.5;        // px at level 0, times the scale of the feature
constexpr double huber = 1.5, hopeless = 4.0;  // standard deviations

double weight_of(double deviations, bool rejects) {
  if (rejects && !(deviations < hopeless)) return 0.0;
  return deviations <= huber ? 1.0 : huber / deviations;
}

/// What the unknowns of ColumnEstimate are multiplied by at a normalised position in the right image.
Eigen::RowVector4d terms_at(double x, double y) {
  const double square = x * x + y * y;
  return {1.0, square, x, x * square};
}

/// In the middle and at the corners of the image [px].
double largest_displacement(const Camera& camera, const Eigen::Vector4d& columns) {
  double largest = std::abs(columns[0]);
  for (const double column : {0.0, static_cast<double>(camera.width)})
    for (const double row : {0.0, static_cast<double>(camera.height)}) {
      const Eigen::Vector2d at = camera.normalised(column, row);
      largest = std::max(largest, std::abs(terms_at(at.x(), at.y()) * columns));
    }
  return largest;
}

/// Whether the motion is longer than the baseline by so much that it triangulates better than the pair.
bool moves_enough(const BundleProblem& problem) {
  constexpr double minimum_baselines = 5.0;
  const Eigen::Isometry3d first = problem.poses.front().T_camera_world;
  double longest = 0.0;
  for (const BundleProblem::Pose& pose : problem.poses)
    longest = std::max(longest, (pose.T_camera_world * first.inverse()).translation().norm());
  return longest > minimum_baselines * problem.camera->baseline;
}

}  // namespace

void PairBundle::add_point(const BundleProblem& problem, std::size_t first, std::size_t last, bool rejects) {
  const Camera& camera = *problem.camera;
  const double fx_baseline = camera.fx * camera.baseline;
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
  PointTerms& terms = points_[problem.observations[first].point];
  terms = {};
  terms.first = couplings_.size();
  const auto of_pose = [](std::size_t pose) { return static_cast<Eigen::Index>(6 * (pose - 1)); };
  const Eigen::Index errors = system_.cols() - columns_.size();
  for (std::size_t o = first; o < last; ++o) {
    const BundleProblem::Observation& seen = problem.observations[o];
    const Eigen::Isometry3d& pose = problem.poses[seen.pose].T_camera_world;
    const Eigen::Vector3d X = pose * problem.points[seen.point];
    if (!(X.z() > min_depth)) continue;
    const double inverse_z = 1.0 / X.z();
    const Eigen::Vector2d pixel = camera.project(X);
    // Rows: x, y, disparity.
    Eigen::Matrix3d by_camera_point;
    by_camera_point << camera.fx * inverse_z, 0.0, -camera.fx * X.x() * inverse_z * inverse_z,  //
        0.0, camera.fy * inverse_z, -camera.fy * X.y() * inverse_z * inverse_z,                 //
        0.0, 0.0, -fx_baseline * inverse_z * inverse_z;
    Eigen::Vector3d residual(seen.x - pixel.x(), seen.y - pixel.y(), 0.0);
    Eigen::Vector3d weight = Eigen::Vector3d::Zero();
    const double information = static_cast<double>(seen.inverse_sigma2) * seen.weight;
    const double deviations = std::sqrt(seen.inverse_sigma2 * residual.squaredNorm());
    weight.head<2>().setConstant(information * weight_of(deviations, rejects));
    Eigen::RowVector4d by_columns = Eigen::RowVector4d::Zero();
    if (!std::isnan(seen.right_x)) {
      by_columns = -terms_at((seen.right_x - camera.cx) / camera.fx, (seen.y - camera.cy) / camera.fy);
      residual.z() = seen.x - seen.right_x - fx_baseline * inverse_z - by_columns * columns_;
      // Weighted by level, as in ORB-SLAM2; see benchmarks/findings/stereo_scale.md.
      const double disparity_information = seen.inverse_sigma2 / (disparity_sigma * disparity_sigma);
      const double off = std::abs(residual.z()) * std::sqrt(disparity_information);
      weight.z() = disparity_information * seen.weight * weight_of(off, rejects) * (weight.x() > 0.0 ? 1.0 : 0.0);
      if (weight.z() > 0.0) squared_sum_ += weight.z() * residual.z() * residual.z(), ++rows_;
    }
    if (weight.x() > 0.0) squared_sum_ += weight.x() * residual.head<2>().squaredNorm(), rows_ += 2;
    const Eigen::Matrix3d by_point = by_camera_point * pose.linear();
    const Eigen::Matrix3d weighted = by_point.transpose() * weight.asDiagonal();
    hessian += weighted * by_point;
    terms.gradient += weighted * residual;
    terms.by_columns += weighted.col(2) * by_columns;
    system_.bottomRightCorner<4, 4>() += weight.z() * by_columns.transpose() * by_columns;
    gradient_.tail<4>() += weight.z() * residual.z() * by_columns.transpose();
    if (seen.pose == 0) continue;
    Eigen::Matrix<double, 3, 6> by_pose;
    by_pose << by_camera_point, -by_camera_point * geometry::hat(X);
    const Eigen::Matrix<double, 6, 3> pose_weighted = by_pose.transpose() * weight.asDiagonal();
    const Eigen::Index at = of_pose(seen.pose);
    system_.block<6, 6>(at, at) += pose_weighted * by_pose;
    system_.block<6, 4>(at, errors) += pose_weighted.col(2) * by_columns;
    gradient_.segment<6>(at) += pose_weighted * residual;
    couplings_.push_back({seen.pose, weighted * by_pose});
  }
  terms.last = couplings_.size();
  rows_ -= 3;
  hessian.diagonal() *= 1.0 + 1e-6;
  hessian.diagonal().array() += 1e-9;
  terms.inverse = hessian.inverse();
  // Schur complement: the upper triangle of the poses, and the errors.
  system_.bottomRightCorner<4, 4>() -= terms.by_columns.transpose() * terms.inverse * terms.by_columns;
  gradient_.tail<4>() -= terms.by_columns.transpose() * (terms.inverse * terms.gradient);
  for (std::size_t i = terms.first; i < terms.last; ++i) {
    const Eigen::Matrix<double, 6, 3> reduced = couplings_[i].by_pose.transpose() * terms.inverse;
    const Eigen::Index at = of_pose(couplings_[i].pose);
    gradient_.segment<6>(at) -= reduced * terms.gradient;
    system_.block<6, 4>(at, errors) -= reduced * terms.by_columns;
    for (std::size_t k = terms.first; k < terms.last; ++k)
      if (couplings_[k].pose >= couplings_[i].pose)
        system_.block<6, 6>(at, of_pose(couplings_[k].pose)) -= reduced * couplings_[k].by_pose;
  }
}

bool PairBundle::iterate(BundleProblem& problem, bool rejects) {
  const auto poses = static_cast<Eigen::Index>(6 * (problem.poses.size() - 1));
  system_.setZero(poses + columns_.size(), poses + columns_.size());
  gradient_.setZero(poses + columns_.size());
  couplings_.clear();
  points_.assign(problem.points.size(), {});
  squared_sum_ = 0.0, rows_ = 0;
  for (std::size_t first = 0, last = 0; first < problem.observations.size(); first = last) {
    while (last < problem.observations.size() && problem.observations[last].point == problem.observations[first].point)
      ++last;
    add_point(problem, first, last, rejects);
  }
  const Eigen::MatrixXd poses_system = system_.topLeftCorner(poses, poses).selfadjointView<Eigen::Upper>();
  const Eigen::LDLT<Eigen::MatrixXd> factor(poses_system);
  if (factor.info() != Eigen::Success || !factor.isPositive()) return false;
  const Eigen::MatrixXd coupling = system_.topRightCorner(poses, columns_.size()), solved = factor.solve(coupling);
  const Eigen::Matrix4d information = system_.bottomRightCorner<4, 4>() - coupling.transpose() * solved;
  const Eigen::Vector4d gradient = gradient_.tail<4>() - solved.transpose() * gradient_.head(poses);
  // A standard deviation of 10 px, which keeps the step finite where motion determines nothing.
  const Eigen::Matrix4d prior = Eigen::Matrix4d::Identity() * 1e-2;
  const Eigen::Vector4d step = (information + prior).ldlt().solve(gradient - prior * columns_);
  const Eigen::VectorXd pose_step = factor.solve(gradient_.head(poses) - coupling * step);
  if (!step.allFinite() || !pose_step.allFinite()) return false;
  columns_ += step;
  for (std::size_t p = 0; p < points_.size(); ++p) {
    Eigen::Vector3d rest = points_[p].gradient - points_[p].by_columns * step;
    for (std::size_t i = points_[p].first; i < points_[p].last; ++i)
      rest -= couplings_[i].by_pose * pose_step.segment<6>(static_cast<Eigen::Index>(6 * (couplings_[i].pose - 1)));
    problem.points[p] += points_[p].inverse * rest;
  }
  for (std::size_t i = 1; i < problem.poses.size(); ++i) {
    Eigen::Isometry3d& pose = problem.poses[i].T_camera_world;
    pose = geometry::exp_se3(pose_step.segment<6>(static_cast<Eigen::Index>(6 * (i - 1)))) * pose;
  }
  result_ = {columns_, information / std::max(1.0, squared_sum_ / std::max(1, rows_ - static_cast<int>(poses)))};
  return true;
}

std::optional<ColumnEstimate> PairBundle::solve(BundleProblem& problem) {
  constexpr std::size_t minimum_points = 50, minimum_poses = 3;
  constexpr int iterations = 6, robust_iterations = 2;
  constexpr double implausible = 5.0;  // px, of a pair that is used as rectified: the world moves
  if (problem.points.size() < minimum_points || problem.poses.size() < minimum_poses) return std::nullopt;
  columns_.setZero();
  for (int iteration = 0; iteration < iterations; ++iteration)
    if (!iterate(problem, iteration >= robust_iterations)) return std::nullopt;
  if (!moves_enough(problem) || largest_displacement(*problem.camera, columns_) > implausible) return std::nullopt;
  return result_;
}

}  // namespace holdfast
