// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/camera_path.hpp"

#include <cmath>
#include <numbers>

#include "holdfast/core/error.hpp"
#include "holdfast/core/random.hpp"

namespace holdfast::simulation {

using Eigen::Vector3d;

namespace {
constexpr double turn = 2.0 * std::numbers::pi;
// In front of the desks of make_room, about 2 m away.
const Vector3d home(3.0, 2.45, 1.38);
const Vector3d desk(3.05, 4.3, 0.88);

// Time as the motion feels it: speed rises smoothly from 0 to 1 within `ramp` seconds.
double eased(double time) {
  constexpr double ramp = 1.0;
  if (time >= ramp) return time - 0.5 * ramp;
  const double t = time / ramp;
  return ramp * (t * t * t - 0.5 * t * t * t * t);  // the integral of smoothstep
}

Vector3d rotated_eye(double azimuth, double elevation, double radius) {
  return desk + radius * Vector3d(std::sin(azimuth) * std::cos(elevation), -std::cos(azimuth) * std::cos(elevation),
                                  std::sin(elevation));
}
}  // namespace

const char* to_string(PathKind kind) {
  switch (kind) {
    case PathKind::fixed:
      return "static";
    case PathKind::xyz:
      return "xyz";
    case PathKind::halfsphere:
      return "halfsphere";
    case PathKind::rpy:
      return "rpy";
  }
  return "";
}

std::vector<std::string> path_names() { return {"static", "xyz", "halfsphere", "rpy"}; }

PathKind path_kind(const std::string& name) {
  for (PathKind kind : {PathKind::fixed, PathKind::xyz, PathKind::halfsphere, PathKind::rpy})
    if (name == to_string(kind)) return kind;
  std::vector<Diagnostic> problems(1);
  problems[0].message = "camera path '" + name + "' is not known; expected static, xyz, halfsphere or rpy";
  throw ConfigurationError(std::move(problems));
}

Eigen::Isometry3d look_at(const Vector3d& eye, const Vector3d& target) {
  const Vector3d forward = (target - eye).normalized();
  const Vector3d right = forward.cross(Vector3d::UnitZ()).normalized();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear().col(0) = right;
  pose.linear().col(1) = forward.cross(right);
  pose.linear().col(2) = forward;
  pose.translation() = eye;
  return pose;
}

CameraPath::CameraPath(PathKind kind, std::uint64_t seed) : kind_(kind) {
  Random random = Random(seed).fork(0x9a7);
  for (double& phase : phases_) phase = random.uniform(0.0, turn);
  for (int axis = 0; axis < 6; ++axis)
    for (int i = 0; i < 5; ++i) {
      // A hand trembles most below 1 Hz; amplitudes fall with frequency so that no frame jumps.
      const double frequency = random.uniform(0.4, 1.0) * (1.0 + 0.9 * i);
      const double size = (axis < 3 ? 0.0035 : 0.0045) / (1.0 + i);
      tremors_[axis].push_back({size * random.uniform(0.5, 1.0), frequency, random.uniform(0.0, turn)});
    }
}

Eigen::Isometry3d CameraPath::pose(double time) const {
  const double t = eased(time);
  const auto wave = [&](int phase, double period) { return std::sin(turn * t / period + phases_[phase]); };
  Eigen::Isometry3d pose;
  switch (kind_) {
    case PathKind::fixed:
      pose = look_at(home, desk);
      break;
    case PathKind::xyz: {
      // One axis after the other comes to the fore.
      const auto swell = [&](int phase, double shift) {
        return 0.62 + 0.38 * std::cos(turn * (t / 19.0 + shift) + phases_[3 + phase] * 0.1);
      };
      const Vector3d offset(0.42 * swell(0, 0.0) * wave(0, 6.1), 0.36 * swell(1, 1.0 / 3) * wave(1, 7.3),
                            0.30 * swell(2, 2.0 / 3) * wave(2, 5.3));
      pose = look_at(home, desk);
      pose.translation() += offset;
      break;
    }
    case PathKind::halfsphere:
      pose = look_at(rotated_eye(0.85 * wave(0, 13.0), 0.62 + 0.38 * wave(1, 8.9), 1.7 + 0.1 * wave(2, 7.7)), desk);
      break;
    case PathKind::rpy: {
      pose = look_at(home, desk);
      const Eigen::Quaterniond rotation = Eigen::AngleAxisd(0.42 * wave(0, 7.9), Vector3d::UnitY()) *
                                          Eigen::AngleAxisd(0.28 * wave(1, 6.1), Vector3d::UnitX()) *
                                          Eigen::AngleAxisd(0.45 * wave(2, 6.9), Vector3d::UnitZ());
      pose.rotate(rotation);
      pose.translation() += 0.03 * Vector3d(wave(3, 4.1), wave(4, 5.3), wave(5, 4.7));
      break;
    }
  }
  double shake[6] = {};
  for (int axis = 0; axis < 6; ++axis)
    for (const Tremor& tremor : tremors_[axis])
      shake[axis] += tremor.amplitude * std::sin(turn * tremor.frequency * t + tremor.phase);
  const Vector3d angles(shake[3], shake[4], shake[5]);
  const double angle = angles.norm();
  pose.translate(Vector3d(shake[0], shake[1], shake[2]));
  if (angle > 0.0) pose.rotate(Eigen::AngleAxisd(angle, angles / angle));
  return pose;
}

}  // namespace holdfast::simulation
