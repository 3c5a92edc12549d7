// SPDX-License-Identifier: BSD-3-Clause
#include "schur/kernels.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <vector>

#include "geometry/synthetic.hpp"
#include "schur/bundle_arrays.hpp"

namespace holdfast::schur_plugin {
namespace {

using geometry::Matrix6d, geometry::Vector6d;
using Residual = Eigen::Vector3d;
const Camera camera = synthetic::camera();

/// A bundle problem in the form of the kernels, with a system of all pairs of free poses.
struct Prepared {
  BundleProblem problem;
  BundleArrays arrays;
  std::vector<double> blocks, cameras, couplings, points;
  std::vector<std::uint32_t> pair_block;
  std::vector<Scratch> scratch;

  explicit Prepared(const BundleProblem& given) : problem(given) {
    BundleSelection selection;
    selection.select(problem);
    arrays.build(problem, selection);
    const std::size_t free = arrays.free_count();
    blocks.assign(block_size * free * (free + 1) / 2, 0.0);
    cameras.assign(camera_size * free, 0.0);
    couplings.assign(coupling_size * arrays.first_coupling.back(), 0.0);
    points.assign(elimination_size * arrays.point_count(), 0.0);
    scratch.resize(arrays.group_count_of_largest_point());
    for (std::size_t p = 0; p < arrays.point_count(); ++p) {
      const std::int32_t* pose = arrays.pose.data() + lanes * arrays.first_group[p];
      const std::uint32_t count = arrays.first_coupling[p + 1] - arrays.first_coupling[p];
      for (std::uint32_t a = 0; a < count; ++a)
        for (std::uint32_t b = 0; b <= a; ++b)
          pair_block.push_back(static_cast<std::uint32_t>(block(pose[a], pose[b])));
    }
  }
  static std::int32_t block(std::int32_t row, std::int32_t column) { return row * (row + 1) / 2 + column; }
  BundleView view(bool is_robust) const {
    BundleView view = arrays.view();
    view.fx = camera.fx, view.fy = camera.fy, view.cx = camera.cx, view.cy = camera.cy;
    view.baseline = camera.baseline;
    view.chi_square_2d = geometry::chi_square_two, view.chi_square_3d = geometry::chi_square_three;
    view.disparity_scale = 1.0 / geometry::disparity_sigma;
    view.disparity_limit = geometry::disparity_threshold * geometry::disparity_threshold;
    view.is_robust = is_robust;
    return view;
  }
  BundleSystem system() {
    return {pair_block.data(), blocks.data(), cameras.data(), couplings.data(), points.data(), scratch.data()};
  }
};

/// Residuals of an observation (column, row, disparity), scaled by the root of their information and weight, from the
/// definition.
Residual residual_of(const BundleProblem::Observation& observation, const Eigen::Isometry3d& T_camera_world,
                     const Eigen::Vector3d& point) {
  const Eigen::Vector3d p = T_camera_world * point;
  const Eigen::Vector2d pixel = camera.project(p);
  Residual result(pixel.x() - observation.x, pixel.y() - observation.y, 0.0);
  result *= std::sqrt(double{observation.inverse_sigma2} * observation.weight);
  if (std::isnan(observation.right_x)) return result;
  const double disparity = static_cast<double>(observation.x) - observation.right_x;
  result.z() = std::sqrt(double{observation.weight}) / geometry::disparity_sigma *
               (camera.fx * camera.baseline / p.z() - disparity);
  return result;
}

struct NumericDerivatives {
  Residual residual;
  Eigen::Matrix<double, 3, 6> by_pose;
  Eigen::Matrix3d by_point;
};
NumericDerivatives differentiate(const BundleProblem::Observation& o, const Eigen::Isometry3d& pose,
                                 const Eigen::Vector3d& point) {
  NumericDerivatives result;
  const double h = 1e-6;
  result.residual = residual_of(o, pose, point);
  for (int i = 0; i < 6; ++i) {
    const Vector6d step = h * Vector6d::Unit(i);
    result.by_pose.col(i) = (residual_of(o, geometry::exp_se3(step) * pose, point) -
                             residual_of(o, geometry::exp_se3(-step) * pose, point)) /
                            (2 * h);
  }
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d step = h * Eigen::Vector3d::Unit(i);
    result.by_point.col(i) = (residual_of(o, pose, point + step) - residual_of(o, pose, point - step)) / (2 * h);
  }
  return result;
}

/// A few points seen by three free and three fixed poses; every seventh observation is far off.
BundleProblem small_problem() {
  BundleProblem problem = synthetic::bundle_case(camera, 3, 3, 20, 6, 1.0, 0.0, 3).problem;
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    problem.observations[i].weight = 0.2f + 0.1f * static_cast<float>(i % 8);
    if (i % 7 == 0) problem.observations[i].y += 50.0f;
  }
  return problem;
}

/// The whole system, from numeric derivatives and Eigen's inverses, as one dense matrix over poses and points.
struct DenseSystem {
  Eigen::MatrixXd hessian;
  Eigen::VectorXd gradient;
  double cost = 0.0;

  DenseSystem(const Prepared& prepared, bool is_robust) {
    const BundleProblem& problem = prepared.problem;
    const auto free = static_cast<Eigen::Index>(prepared.arrays.free_count());
    const Eigen::Index size = 6 * free + 3 * static_cast<Eigen::Index>(prepared.arrays.point_count());
    hessian.setZero(size, size);
    gradient.setZero(size);
    std::vector<Eigen::Index> pose_number(problem.poses.size(), -1), point_number(problem.points.size(), -1);
    for (Eigen::Index i = 0; i < free; ++i) pose_number[prepared.arrays.pose_indices[static_cast<std::size_t>(i)]] = i;
    for (std::size_t i = 0; i < prepared.arrays.point_count(); ++i)
      point_number[prepared.arrays.point_indices[i]] = static_cast<Eigen::Index>(i);
    for (const BundleProblem::Observation& o : problem.observations) {
      if (point_number[o.point] < 0) continue;
      const NumericDerivatives d = differentiate(o, problem.poses[o.pose].T_camera_world, problem.points[o.point]);
      const double limit = o.weight * (std::isnan(o.right_x) ? geometry::chi_square_two : geometry::chi_square_three);
      const double threshold = geometry::disparity_threshold * std::sqrt(double{o.weight});
      const double deviation = std::abs(d.residual.z());
      const bool wrong_depth = deviation > threshold;
      const Eigen::Vector3d slopes(1.0, 1.0, wrong_depth ? threshold / deviation : 1.0);
      const double squared =
          d.residual.head<2>().squaredNorm() +
          (wrong_depth ? 2.0 * threshold * deviation - threshold * threshold : deviation * deviation);
      const bool beyond = is_robust && squared > limit;
      const double slope = beyond ? std::sqrt(limit / squared) : 1.0;
      cost += 0.5 * (beyond ? 2.0 * std::sqrt(limit * squared) - limit : squared);
      Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(3, size);
      if (pose_number[o.pose] >= 0) jacobian.middleCols<6>(6 * pose_number[o.pose]) = d.by_pose;
      jacobian.middleCols<3>(6 * free + 3 * point_number[o.point]) = d.by_point;
      hessian += slope * jacobian.transpose() * slopes.asDiagonal() * jacobian;
      gradient += slope * jacobian.transpose() * slopes.asDiagonal() * d.residual;
    }
  }
};

void check_against_numeric_derivatives(bool is_robust, double damping) {
  Prepared prepared(small_problem());
  const DenseSystem dense(prepared, is_robust);
  const Kernels& kernel = kernels(simd_level());
  const BundleView view = prepared.view(is_robust);
  EXPECT_NEAR(kernel.cost(view, nullptr), dense.cost, 1e-9 * dense.cost);
  kernel.eliminate(view, damping, prepared.system());

  const auto free = static_cast<Eigen::Index>(prepared.arrays.free_count());
  const Eigen::Index points = dense.hessian.rows() - 6 * free;
  Eigen::MatrixXd point_part = dense.hessian.bottomRightCorner(points, points);
  point_part.diagonal() *= 1.0 + damping;
  const Eigen::MatrixXd coupling = dense.hessian.topRightCorner(6 * free, points);
  const Eigen::MatrixXd inverse = point_part.inverse();
  const Eigen::MatrixXd eliminated = coupling * inverse * coupling.transpose();
  const Eigen::VectorXd reduced = dense.gradient.head(6 * free) - coupling * inverse * dense.gradient.tail(points);
  for (Eigen::Index i = 0; i < free; ++i) {
    const double* found = prepared.cameras.data() + static_cast<Eigen::Index>(camera_size) * i;
    const Matrix6d hessian = dense.hessian.block<6, 6>(6 * i, 6 * i);
    EXPECT_LT((Eigen::Map<const Matrix6d>(found) - hessian).norm(), 1e-6 * hessian.norm()) << i;
    EXPECT_LT((Vector6d::Map(found + 36) - dense.gradient.segment<6>(6 * i)).norm(), 1e-6 * dense.gradient.norm()) << i;
    EXPECT_LT((Vector6d::Map(found + 42) - reduced.segment<6>(6 * i)).norm(), 1e-6 * dense.gradient.norm()) << i;
    for (Eigen::Index k = 0; k <= i; ++k) {
      const int block = Prepared::block(static_cast<int>(i), static_cast<int>(k));
      const Eigen::Map<const Matrix6d> minus(prepared.blocks.data() + static_cast<int>(block_size) * block);
      EXPECT_LT((minus + eliminated.block<6, 6>(6 * i, 6 * k)).norm(), 1e-6 * hessian.norm()) << i << ' ' << k;
    }
  }

  // Any step of the poses gives the steps of the points that solve their equations.
  const Eigen::VectorXd step = 1e-3 * Eigen::VectorXd::LinSpaced(6 * free, -1.0, 2.0);
  std::vector<double> repeated, moved(static_cast<std::size_t>(points));
  for (Eigen::Index i = 0; i < free; ++i)
    for (std::size_t k = 0; k < coupling_size; ++k) repeated.push_back(step[6 * i + static_cast<Eigen::Index>(k % 6)]);
  const double decrease = kernel.substitute(view, prepared.system(), repeated.data(), moved.data());
  const Eigen::VectorXd expected = -inverse * (dense.gradient.tail(points) + coupling.transpose() * step);
  for (Eigen::Index i = 0; i < points; ++i)
    EXPECT_NEAR(moved[static_cast<std::size_t>(i)] - prepared.arrays.points[static_cast<std::size_t>(i)], expected[i],
                1e-7);
  const Eigen::VectorXd scaled = damping * dense.hessian.diagonal().tail(points).cwiseProduct(expected);
  const double predicted =
      0.5 * (expected.dot(scaled) + dense.gradient.tail(points).dot(inverse * dense.gradient.tail(points) +
                                                                    inverse * coupling.transpose() * step));
  EXPECT_NEAR(decrease, predicted, 1e-6 * std::abs(predicted));
}

TEST(SchurKernels, AgreeWithNumericDerivatives) {
  check_against_numeric_derivatives(false, 1e-4);
  check_against_numeric_derivatives(true, 0.3);
}

TEST(SchurKernels, WriteTheChiSquareOfEachObservation) {
  const Prepared prepared(small_problem());
  std::vector<double> chi_squares(prepared.arrays.entry_count());
  kernels(simd_level()).cost(prepared.view(false), chi_squares.data());
  for (std::size_t i = 0; i < chi_squares.size(); ++i) {
    if (prepared.arrays.entries[i] == BundleArrays::none) continue;
    const BundleProblem::Observation& o = prepared.problem.observations[prepared.arrays.entries[i]];
    const double expected =
        chi_square(camera, prepared.problem.poses[o.pose].T_camera_world, prepared.problem.points[o.point], o);
    EXPECT_NEAR(chi_squares[i], expected, 1e-9 * (1.0 + expected));
  }
}

TEST(SchurKernels, BehindTheCameraIsDearAndFlat) {
  Prepared prepared(small_problem());
  const BundleView view = prepared.view(false);
  for (std::size_t i = 2; i < prepared.arrays.points.size(); i += 3) prepared.arrays.points[i] = -5.0;
  const Kernels& kernel = kernels(simd_level());
  EXPECT_GT(kernel.cost(view, nullptr), 100.0 * static_cast<double>(prepared.problem.observations.size()));
  kernel.eliminate(view, 1e-4, prepared.system());
  for (const double each : prepared.cameras) EXPECT_EQ(each, 0.0);
  for (const double each : prepared.couplings) EXPECT_EQ(each, 0.0);
}

TEST(SchurKernels, EveryLevelGivesTheSameBits) {
  const BundleProblem problem = synthetic::bundle_case(camera, 4, 5, 200, 7, 1.0, 0.1, 4).problem;
  const auto solve = [&](SimdLevel level) {
    const Kernels& kernel = kernels(level);
    std::vector<double> all;
    for (const bool is_robust : {true, false}) {
      Prepared prepared(problem);
      std::vector<double> chi_squares(prepared.arrays.entry_count()), moved(prepared.arrays.points.size());
      const BundleView view = prepared.view(is_robust);
      all.push_back(kernel.cost(view, chi_squares.data()));
      kernel.eliminate(view, 1e-3, prepared.system());
      const std::vector<double> steps(coupling_size * prepared.arrays.free_count(), 1e-3);
      all.push_back(kernel.substitute(view, prepared.system(), steps.data(), moved.data()));
      for (const auto* each :
           {&chi_squares, &moved, &prepared.blocks, &prepared.cameras, &prepared.couplings, &prepared.points})
        all.insert(all.end(), each->begin(), each->end());
    }
    return all;
  };
  const std::vector<double> expected = solve(SimdLevel::scalar);
  for (const SimdLevel level : simd_levels) {
    if (!has_simd_level(level)) break;
    const std::vector<double> found = solve(level);
    ASSERT_EQ(found.size(), expected.size());
    EXPECT_EQ(std::memcmp(found.data(), expected.data(), sizeof(double) * found.size()), 0) << to_string(level);
  }
}

}  // namespace
}  // namespace holdfast::schur_plugin
