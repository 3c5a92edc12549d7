// SPDX-License-Identifier: BSD-3-Clause
#include "optimizer_problems.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "holdfast/core/random.hpp"

namespace holdfast::conformance {

namespace {

constexpr float no_depth = std::numeric_limits<float>::quiet_NaN();

Eigen::Vector3d vector(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

Eigen::Isometry3d pose(Random& random, double metres, double radians) {
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.translation() = vector(random, metres);
  const Eigen::Vector3d axis = vector(random, 1.0) + Eigen::Vector3d(0.1, 0.2, 1.5);
  result.linear() = Eigen::AngleAxisd(random.uniform(-radians, radians), axis.normalized()).toRotationMatrix();
  return result;
}

Eigen::Vector3d point_in_view(Random& random) {
  return {random.uniform(-1.0, 1.0), random.uniform(-0.7, 0.7), random.uniform(2.0, 4.0)};
}

}  // namespace

KnownPose known_pose(const Camera& camera, std::size_t points, std::uint64_t seed) {
  Random random(seed);
  KnownPose known{{}, pose(random, 0.3, 0.2)};
  PoseProblem& problem = known.problem;
  problem.camera = &camera;
  for (std::size_t i = 0; i < points; ++i) {
    const Eigen::Vector3d seen = point_in_view(random);
    const Eigen::Vector2d pixel = camera.project(seen);
    problem.points.push_back(known.truth.inverse() * seen);
    problem.x.push_back(static_cast<float>(pixel.x())), problem.y.push_back(static_cast<float>(pixel.y()));
    problem.right_x.push_back(i % 3 == 0 ? static_cast<float>(camera.right_x(pixel.x(), seen.z())) : no_depth);
    problem.inverse_sigma2.push_back(1.0F / static_cast<float>(1 + i % 3));
    problem.weight.push_back(1.0F);
  }
  problem.T_camera_world = pose(random, 0.03, 0.02) * known.truth;
  return known;
}

KnownBundle known_bundle(const Camera& camera, std::uint64_t seed) {
  Random random(seed + 100);
  KnownBundle known;
  BundleProblem& problem = known.problem;
  problem.camera = &camera;
  for (int i = 0; i < 90; ++i) known.points.push_back(point_in_view(random));
  for (std::uint32_t i = 0; i < 5; ++i) {
    Eigen::Isometry3d T_camera_world = pose(random, 0.15, 0.08);
    known.poses.push_back(T_camera_world);
    for (std::uint32_t k = 0; k < known.points.size(); ++k) {
      const Eigen::Vector3d seen = T_camera_world * known.points[k];
      const Eigen::Vector2d pixel = camera.project(seen);
      const bool has_depth = (i + k) % 2 == 0;
      problem.observations.push_back(
          {.pose = i,
           .point = k,
           .x = static_cast<float>(pixel.x()),
           .y = static_cast<float>(pixel.y()),
           .right_x = has_depth ? static_cast<float>(camera.right_x(pixel.x(), seen.z())) : no_depth});
    }
    const bool fixed = i < 2;
    problem.poses.push_back({fixed ? T_camera_world : pose(random, 0.01, 0.005) * T_camera_world, fixed});
  }
  for (const Eigen::Vector3d& point : known.points) problem.points.push_back(point + vector(random, 0.01));
  return known;
}

KnownGraph known_graph(std::uint64_t seed) {
  Random random(seed + 200);
  KnownGraph known;
  constexpr std::uint32_t count = 8;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / count;
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
    T_world_camera.translation() = Eigen::Vector3d(2.0 * std::cos(angle), 0.1 * i, 2.0 * std::sin(angle));
    T_world_camera.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()).toRotationMatrix();
    known.poses.push_back(T_world_camera.inverse());
    known.problem.nodes.push_back({i == 0 ? known.poses[0] : pose(random, 0.1, 0.05) * known.poses[i], i == 0});
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t next = (i + 1) % count;
    known.problem.edges.push_back({i, next, known.poses[next] * known.poses[i].inverse(), 1.0});
  }
  return known;
}

double distance(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  const Eigen::Isometry3d difference = a * b.inverse();
  return difference.translation().norm() + std::abs(Eigen::AngleAxisd(difference.linear()).angle());
}

bool is_rigid(const Eigen::Isometry3d& pose) {
  const Eigen::Matrix3d R = pose.linear();
  return pose.matrix().allFinite() && (R * R.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-6 &&
         R.determinant() > 0.0;
}

}  // namespace holdfast::conformance
