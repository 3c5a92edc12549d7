// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "holdfast/dense_map/kept_view.hpp"
#include "holdfast/surface/surface_field.hpp"
#include "holdfast/surface/surface_map.hpp"

namespace holdfast::test {

/// A ball and, where asked for, a wall at z = 2.5 m and a box in front of the wall, seen by a small camera.
struct SolidWorld {
  static constexpr double radius = 0.4, wall_z = 2.5;

  Camera camera;
  Eigen::Vector3d centre{0, 0, 1.5};
  bool has_ball = true, has_wall = false, has_box = false;
  Eigen::AlignedBox3d box{Eigen::Vector3d(-0.3, -0.3, 1.6), Eigen::Vector3d(0.3, 0.3, 2.0)};

  SolidWorld() {
    camera.width = 160;
    camera.height = 120;
    camera.fx = camera.fy = 130;
    camera.cx = 79.5;
    camera.cy = 59.5;
  }

  /// Distance along a ray, or infinity.
  double cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) const {
    double nearest = std::numeric_limits<double>::infinity();
    if (has_ball) {
      const Eigen::Vector3d offset = origin - centre;
      const double a = ray.squaredNorm(), b = offset.dot(ray), c = offset.squaredNorm() - radius * radius;
      if (const double d = b * b - a * c; d > 0.0 && -b - std::sqrt(d) > 0.0) nearest = (-b - std::sqrt(d)) / a;
    }
    if (has_wall && ray.z() > 0.0 && origin.z() < wall_z) nearest = std::min(nearest, (wall_z - origin.z()) / ray.z());
    if (has_box) {
      double in = 0.0, out = nearest;
      for (int i = 0; i < 3; ++i) {
        const double a = (box.min()[i] - origin[i]) / ray[i], b = (box.max()[i] - origin[i]) / ray[i];
        in = std::max(in, std::min(a, b)), out = std::min(out, std::max(a, b));
      }
      if (in < out && in > 0.0) nearest = std::min(nearest, in);
    }
    return nearest;
  }

  KeptView view(const Eigen::Isometry3d& T_world_camera, std::uint64_t index) const {
    KeptView view{
        .keyframe = {}, .frame_index = index, .timestamp = 0.1 * static_cast<double>(index), .colour = {}, .depth = {}};
    view.colour.create(camera.height, camera.width, CV_8UC3);
    view.colour.setTo(cv::Scalar(10, 100, 200));
    view.depth.create(camera.height, camera.width, CV_16UC1);
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const double depth =
            cast(T_world_camera.translation(), T_world_camera.linear() * camera.back_project(x, y, 1.0));
        view.depth.at<std::uint16_t>(y, x) =
            depth < 16.0 ? static_cast<std::uint16_t>(std::lround(depth / KeptView::depth_unit)) : std::uint16_t{0};
      }
    return view;
  }
};

/// A camera at `position` that looks at `target`, y down along -`up`.
inline Eigen::Isometry3d look_at(const Eigen::Vector3d& position, const Eigen::Vector3d& target) {
  const Eigen::Vector3d ahead = (target - position).normalized();
  const Eigen::Vector3d helper = std::abs(ahead.y()) < 0.9 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d right = helper.cross(ahead).normalized();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear().col(0) = right;
  pose.linear().col(1) = ahead.cross(right);
  pose.linear().col(2) = ahead;
  pose.translation() = position;
  return pose;
}

/// Forty poses all around a point, by the golden spiral.
inline std::vector<Eigen::Isometry3d> poses_around(const Eigen::Vector3d& target, double distance) {
  constexpr int count = 40;
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count, r = std::sqrt(1.0 - z * z),
                 turn = M_PI * (3.0 - std::sqrt(5.0)) * i;
    poses.push_back(look_at(target + distance * Eigen::Vector3d(r * std::cos(turn), r * std::sin(turn), z), target));
  }
  return poses;
}

}  // namespace holdfast::test
