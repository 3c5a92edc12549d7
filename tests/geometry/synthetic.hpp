// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

#include "holdfast/core/random.hpp"
#include "holdfast/geometry/se3.hpp"
#include "holdfast/interfaces/optimizer.hpp"

/// Problems with known answers for the tests and the benchmark of the optimizer.
namespace holdfast::synthetic {

inline Camera camera() {
  Camera result;
  result.fx = 517.3, result.fy = 516.5, result.cx = 318.6, result.cy = 255.3, result.baseline = 0.08;
  return result;
}

inline geometry::Vector6d tangent(Random& random, double metres, double radians) {
  geometry::Vector6d result;
  for (int i = 0; i < 3; ++i) result[i] = metres * random.normal();
  for (int i = 3; i < 6; ++i) result[i] = radians * random.normal();
  return result;
}

/// Metres and radians between two poses, as one number.
inline double distance(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return geometry::log_se3(a * b.inverse()).norm();
}

struct PoseCase {
  PoseProblem problem;
  Eigen::Isometry3d truth;
  std::vector<std::uint8_t> is_outlier;
};

/// `pixel_noise` [px]; a part `outliers` of the observations is off by 20 to 80 pixels; a third has no depth.
inline PoseCase pose_case(const Camera& camera, int count, double pixel_noise, double outliers, std::uint64_t seed) {
  Random random(seed);
  PoseCase result;
  result.truth = geometry::exp_se3(tangent(random, 0.5, 0.3));
  const Eigen::Isometry3d T_world_camera = result.truth.inverse();
  PoseProblem& problem = result.problem;
  problem.camera = &camera;
  for (int i = 0; i < count; ++i) {
    const double x = random.uniform(0, camera.width), y = random.uniform(0, camera.height);
    const double depth = random.uniform(0.6, 5.0);
    problem.points.push_back(T_world_camera * camera.back_project(x, y, depth));
    double dx = pixel_noise * random.normal(), dy = pixel_noise * random.normal();
    const bool off = random.uniform() < outliers;
    if (off) dx += random.uniform(20, 80), dy += random.uniform(-80, 80);
    result.is_outlier.push_back(off);
    problem.x.push_back(static_cast<float>(x + dx));
    problem.y.push_back(static_cast<float>(y + dy));
    const double right = camera.right_x(x, depth) + (off ? dx : 0.0) + pixel_noise * random.normal();
    problem.right_x.push_back(i % 3 ? static_cast<float>(right) : std::numeric_limits<float>::quiet_NaN());
    problem.inverse_sigma2.push_back(pixel_noise > 0 ? static_cast<float>(1.0 / (pixel_noise * pixel_noise)) : 1.0f);
    problem.weight.push_back(1.0f);
  }
  problem.T_camera_world = geometry::exp_se3(tangent(random, 0.03, 0.02)) * result.truth;
  return result;
}

struct BundleCase {
  BundleProblem problem;
  std::vector<Eigen::Isometry3d> poses;
  std::vector<Eigen::Vector3d> points;
  std::vector<std::uint8_t> is_outlier;
};

/// A camera that walks sideways along a wall of points, `fixed` poses first, then the free ones. Each point is seen by
/// neighbouring poses, `track` of them at most; a part `outliers` of the observations is far off.
inline BundleCase bundle_case(const Camera& camera, int fixed, int free, int points, int track, double pixel_noise,
                              double outliers, std::uint64_t seed) {
  Random random(seed);
  BundleCase result;
  BundleProblem& problem = result.problem;
  problem.camera = &camera;
  const int poses = fixed + free;
  for (int i = 0; i < poses; ++i) {
    geometry::Vector6d wobble = tangent(random, 0.03, 0.03);
    wobble[0] -= 0.08 * i;
    result.poses.push_back(geometry::exp_se3(wobble));
    // Every other pose is fixed while there are fixed ones left, so that free ones lie between them.
    const bool is_fixed = i % 2 == 0 ? i / 2 < fixed : poses - i <= fixed - (i + 1) / 2;
    const Eigen::Isometry3d start = geometry::exp_se3(tangent(random, 0.02, 0.01)) * result.poses.back();
    problem.poses.push_back({is_fixed ? result.poses.back() : start, is_fixed});
  }
  while (static_cast<int>(result.points.size()) < points) {
    const int first = static_cast<int>(random.below(static_cast<std::uint32_t>(poses)));
    const Eigen::Isometry3d T_world_camera = result.poses[first].inverse();
    const double x = random.uniform(0, camera.width), y = random.uniform(0, camera.height);
    const Eigen::Vector3d point = T_world_camera * camera.back_project(x, y, random.uniform(0.8, 4.0));
    std::vector<BundleProblem::Observation> seen;
    for (int i = std::max(0, first - track / 2); i < poses && static_cast<int>(seen.size()) < track; ++i) {
      const Eigen::Vector3d p = result.poses[i] * point;
      if (p.z() < 0.3) continue;
      const Eigen::Vector2d pixel = camera.project(p);
      if (pixel.x() < 0 || pixel.y() < 0 || pixel.x() >= camera.width || pixel.y() >= camera.height) continue;
      BundleProblem::Observation observation;
      observation.pose = static_cast<std::uint32_t>(i);
      observation.point = static_cast<std::uint32_t>(result.points.size());
      observation.x = static_cast<float>(pixel.x() + pixel_noise * random.normal());
      observation.y = static_cast<float>(pixel.y() + pixel_noise * random.normal());
      observation.right_x = random.uniform() < 0.7
                                ? static_cast<float>(camera.right_x(pixel.x(), p.z()) + pixel_noise * random.normal())
                                : std::numeric_limits<float>::quiet_NaN();
      observation.inverse_sigma2 = static_cast<float>(1.0 / (pixel_noise * pixel_noise));
      seen.push_back(observation);
    }
    if (seen.size() < 3) continue;
    for (BundleProblem::Observation& observation : seen) {
      const bool off = random.uniform() < outliers;
      if (off) observation.x += 30.0f + 20.0f * static_cast<float>(random.uniform());
      result.is_outlier.push_back(off);
      problem.observations.push_back(observation);
    }
    result.points.push_back(point);
    problem.points.push_back(point +
                             Eigen::Vector3d{0.02 * random.normal(), 0.02 * random.normal(), 0.02 * random.normal()});
  }
  return result;
}

}  // namespace holdfast::synthetic
