// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/camera.hpp"

#include <algorithm>
#include <array>

namespace holdfast {

Eigen::Vector2d Camera::distort(const Eigen::Vector2d& pixel) const {
  const Distortion& d = distortion;
  const double x = (pixel.x() - cx) / fx, y = (pixel.y() - cy) / fy;
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (d.k1 + r2 * (d.k2 + r2 * d.k3));
  const double distorted_x = x * radial + 2.0 * d.p1 * x * y + d.p2 * (r2 + 2.0 * x * x);
  const double distorted_y = y * radial + d.p1 * (r2 + 2.0 * y * y) + 2.0 * d.p2 * x * y;
  return {fx * distorted_x + cx, fy * distorted_y + cy};
}

Eigen::Vector2d Camera::undistort(const Eigen::Vector2d& raw) const {
  if (distortion.is_zero()) return raw;
  const Distortion& d = distortion;
  const double raw_x = (raw.x() - cx) / fx, raw_y = (raw.y() - cy) / fy;
  double x = raw_x, y = raw_y;
  constexpr int most_iterations = 40;
  for (int i = 0; i < most_iterations; ++i) {
    const double r2 = x * x + y * y;
    const double inverse_radial = 1.0 / (1.0 + r2 * (d.k1 + r2 * (d.k2 + r2 * d.k3)));
    const double next_x = (raw_x - 2.0 * d.p1 * x * y - d.p2 * (r2 + 2.0 * x * x)) * inverse_radial;
    const double next_y = (raw_y - d.p1 * (r2 + 2.0 * y * y) - 2.0 * d.p2 * x * y) * inverse_radial;
    const double change = std::max(std::abs(next_x - x), std::abs(next_y - y));
    x = next_x, y = next_y;
    if (change < 1e-9) break;
  }
  return {fx * x + cx, fy * y + cy};
}

void Camera::undistorted_bounds(Eigen::Vector2d& minimum, Eigen::Vector2d& maximum) const {
  minimum = {0.0, 0.0};
  maximum = {width - 1.0, height - 1.0};
  if (distortion.is_zero()) return;
  minimum.setConstant(1e9);
  maximum.setConstant(-1e9);
  constexpr int steps = 16;
  for (int i = 0; i <= steps; ++i) {
    const double x = (width - 1.0) * i / steps, y = (height - 1.0) * i / steps;
    for (const Eigen::Vector2d& border : {Eigen::Vector2d(x, 0.0), Eigen::Vector2d(x, height - 1.0),
                                          Eigen::Vector2d(0.0, y), Eigen::Vector2d(width - 1.0, y)}) {
      const Eigen::Vector2d pixel = undistort(border);
      minimum = minimum.cwiseMin(pixel);
      maximum = maximum.cwiseMax(pixel);
    }
  }
}

namespace {
const std::array<Camera, 6>& known_cameras() {
  // TUM: https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats (colour camera of each freiburg setup).
  // Bonn: https://www.ipb.uni-bonn.de/data/rgbd-dynamic-dataset (colour camera). ICL-NUIM: Handa et al., ICRA 2014, who
  // give fy as -480 because the y axis of their renderer points up; here y points down.
  static const std::array<Camera, 6> cameras = {{
      {"bonn",
       640,
       480,
       542.822841,
       542.576870,
       315.593520,
       237.756098,
       {0.039903, -0.099343, -0.000730, -0.000144, 0.0},
       0.08,
       30.0},
      {"icl_nuim", 640, 480, 481.20, 480.00, 319.50, 239.50, {}, 0.08, 30.0},
      {"kinect2", 960, 540, 540.686, 540.686, 479.75, 269.75, {}, 0.08, 30.0},
      {"tum_fr1",
       640,
       480,
       517.306408,
       516.469215,
       318.643040,
       255.313989,
       {0.262383, -0.953104, -0.005358, 0.002628, 1.163314},
       0.08,
       30.0},
      {"tum_fr2",
       640,
       480,
       520.908620,
       521.007327,
       325.141442,
       249.701764,
       {0.231222, -0.784899, -0.003257, -0.000105, 0.917205},
       0.08,
       30.0},
      {"tum_fr3", 640, 480, 535.4, 539.2, 320.1, 247.6, {}, 0.08, 30.0},
  }};
  return cameras;
}
}  // namespace

std::optional<Camera> find_camera(const std::string& name) {
  for (const Camera& camera : known_cameras())
    if (camera.name == name) return camera;
  return std::nullopt;
}

std::vector<std::string> camera_names() {
  std::vector<std::string> names;
  for (const Camera& camera : known_cameras()) names.push_back(camera.name);
  return names;
}

}  // namespace holdfast
