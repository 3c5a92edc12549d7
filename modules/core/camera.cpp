// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/camera.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "lens_inverse.hpp"

namespace holdfast {

namespace {

/// Where the undistorted image of a fisheye lens ends: beyond Camera::usable_angle, so that tables that are
/// interpolated are exact up to there.
constexpr double largest_angle = 65.0 / 180.0 * 3.14159265358979323846;

/// The angle of a distance, at most `limit`: the first at which the polynomial reaches the distance. Newton steps that
/// leave the interval of the solution are replaced by bisection, so that polynomials that turn back end at the limit.
double fisheye_angle(const Distortion& d, double radius, double limit) {
  if (!(radius < fisheye_radius(d, limit))) return limit;
  double low = 0.0, high = limit, angle = std::min(radius, limit);
  constexpr int most_iterations = 60;
  for (int i = 0; i < most_iterations; ++i) {
    const double error = fisheye_radius(d, angle) - radius;
    (error > 0.0 ? high : low) = angle;
    double next = angle - error / fisheye_slope(d, angle);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    const double change = std::abs(next - angle);
    angle = next;
    if (change < 1e-14) break;
  }
  return angle;
}

}  // namespace

const std::vector<std::string>& lens_names() {
  static const std::vector<std::string> names = {"radial_tangential", "fisheye"};
  return names;
}

const char* lens_name(Lens lens) { return lens_names()[static_cast<std::size_t>(lens)].c_str(); }

std::optional<Lens> find_lens(const std::string& name) {
  for (const Lens lens : {Lens::radial_tangential, Lens::fisheye})
    if (name == lens_name(lens)) return lens;
  return std::nullopt;
}

std::vector<double> Distortion::coefficients() const {
  if (lens == Lens::fisheye) return {k1, k2, k3, k4};
  if (is_rational()) return {k1, k2, p1, p2, k3, k4, k5, k6};
  return {k1, k2, p1, p2, k3};
}

std::string Distortion::trouble() const {
  if (lens != Lens::fisheye) return "";
  if (p1 != 0 || p2 != 0 || k5 != 0 || k6 != 0)
    return "a fisheye lens has the coefficients k1, k2, k3 and k4 alone; expected p1, p2, k5 and k6 to be 0";
  if (!(fisheye_radius(*this, largest_angle) > 0.0))
    return "the image of a ray at 65 degrees lies behind the principal point; expected coefficients of a fisheye lens";
  return "";
}

Eigen::Vector2d Camera::distort(const Eigen::Vector2d& pixel) const {
  const Distortion& d = distortion;
  const Eigen::Vector2d at = normalised(pixel.x(), pixel.y());
  const double x = at.x(), y = at.y();
  if (d.lens == Lens::fisheye) {
    const double r = std::sqrt(x * x + y * y);
    const double scale = r > 1e-12 ? fisheye_radius(d, std::atan(r)) / r : 1.0;
    return {fx * x * scale + cx, fy * y * scale + cy};
  }
  const Eigen::Vector2d distorted = distort_radial_tangential(d, x, y);
  return {fx * distorted.x() + cx, fy * distorted.y() + cy};
}

Eigen::Vector2d Camera::undistort(const Eigen::Vector2d& raw) const {
  if (distortion.is_zero()) return raw;
  const Distortion& d = distortion;
  const Eigen::Vector2d at = normalised(raw.x(), raw.y());
  const double raw_x = at.x(), raw_y = at.y();
  if (d.lens == Lens::fisheye) {
    const double radius = std::hypot(raw_x, raw_y);
    const double scale = radius > 1e-12 ? std::tan(fisheye_angle(d, radius, largest_angle)) / radius : 1.0;
    return {fx * raw_x * scale + cx, fy * raw_y * scale + cy};
  }
  double x = raw_x, y = raw_y, change = 0.0;
  constexpr int most_iterations = 40;
  for (int i = 0; i < most_iterations; ++i) {
    const double r2 = x * x + y * y;
    const double inverse_radial = radial_denominator(d, r2) / radial_numerator(d, r2);
    const double next_x = (raw_x - 2.0 * d.p1 * x * y - d.p2 * (r2 + 2.0 * x * x)) * inverse_radial;
    const double next_y = (raw_y - d.p1 * (r2 + 2.0 * y * y) - 2.0 * d.p2 * x * y) * inverse_radial;
    change = std::max(std::abs(next_x - x), std::abs(next_y - y));
    x = next_x, y = next_y;
    if (change < 1e-9) break;
  }
  const Eigen::Vector2d undistorted(fx * x + cx, fy * y + cy);
  constexpr double accepted = 1e-3;  // px
  if (change < 1e-9 || (distort(undistorted) - raw).norm() < accepted) return undistorted;
  const Eigen::Vector2d point = invert_distortion(d, at).point;
  return {fx * point.x() + cx, fy * point.y() + cy};
}

bool Camera::is_usable(const Eigen::Vector2d& raw) const {
  if (distortion.lens != Lens::fisheye) return true;
  const Eigen::Vector2d at = normalised(raw.x(), raw.y());
  return fisheye_angle(distortion, std::hypot(at.x(), at.y()), largest_angle) <= usable_angle;
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
/// Of the colour camera of a Kinect [s], as estimated while tracking freiburg1_xyz and freiburg1_rpy
/// (benchmarks/findings/rotation.md). The Xtion of tum_fr3 and bonn has the same design, and estimation begins with the
/// same time there.
constexpr double kinect_readout = 0.026;

const std::array<Camera, 10>& known_cameras() {
  // TUM: https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats (colour camera of each freiburg setup).
  // Bonn: https://www.ipb.uni-bonn.de/data/rgbd-dynamic-dataset (colour camera). ICL-NUIM: Handa et al., ICRA 2014, who
  // give fy as -480 because the y axis of their renderer points up; here y points down. EuRoC: Burri et al., IJRR 2016,
  // mav0/cam0/sensor.yaml of every sequence, and the distance of the two cameras. KITTI: Geiger et al., CVPR 2012,
  // calib.txt of the odometry sequences 00 to 02, 03, and 04 to 12, rectified grey pair.
  static const std::array<Camera, 10> cameras = {{
      {"bonn",
       640,
       480,
       542.822841,
       542.576870,
       315.593520,
       237.756098,
       {0.039903, -0.099343, -0.000730, -0.000144, 0.0},
       0.08,
       30.0,
       kinect_readout},
      {"euroc",
       752,
       480,
       458.654,
       457.296,
       367.215,
       248.375,
       {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0.0},
       0.110077842,
       20.0},
      {"icl_nuim", 640, 480, 481.20, 480.00, 319.50, 239.50, {}, 0.08, 30.0},
      {"kinect2", 960, 540, 540.686, 540.686, 479.75, 269.75, {}, 0.08, 30.0},
      {"kitti_00", 1241, 376, 718.856, 718.856, 607.1928, 185.2157, {}, 386.1448 / 718.856, 10.0},
      {"kitti_03", 1242, 375, 721.5377, 721.5377, 609.5593, 172.854, {}, 387.5744 / 721.5377, 10.0},
      {"kitti_04", 1226, 370, 707.0912, 707.0912, 601.8873, 183.1104, {}, 379.8145 / 707.0912, 10.0},
      {"tum_fr1",
       640,
       480,
       517.306408,
       516.469215,
       318.643040,
       255.313989,
       {0.262383, -0.953104, -0.005358, 0.002628, 1.163314},
       0.08,
       30.0,
       kinect_readout},
      {"tum_fr2",
       640,
       480,
       520.908620,
       521.007327,
       325.141442,
       249.701764,
       {0.231222, -0.784899, -0.003257, -0.000105, 0.917205},
       0.08,
       30.0,
       kinect_readout},
      {"tum_fr3", 640, 480, 535.4, 539.2, 320.1, 247.6, {}, 0.08, 30.0, kinect_readout},
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
