// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/camera_path.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "full_turn.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/random.hpp"

namespace holdfast::simulation {

using Eigen::Vector3d;

namespace {
// Time as the motion feels it: speed rises smoothly from 0 to 1 within `ramp` seconds.
double eased(double time) {
  constexpr double ramp = 1.0;
  if (time >= ramp) return time - 0.5 * ramp;
  const double t = time / ramp;
  return ramp * (t * t * t - 0.5 * t * t * t * t);  // the integral of smoothstep
}

constexpr std::pair<PathKind, const char*> path_kinds[] = {{PathKind::fixed, "static"},
                                                           {PathKind::xyz, "xyz"},
                                                           {PathKind::halfsphere, "halfsphere"},
                                                           {PathKind::rpy, "rpy"},
                                                           {PathKind::loop, "loop"},
                                                           {PathKind::corridor, "corridor"},
                                                           {PathKind::table_edge, "table_edge"},
                                                           {PathKind::rotation, "rotation"},
                                                           {PathKind::square, "square"},
                                                           {PathKind::waypoints, "waypoints"}};

constexpr double edge_stroke = 0.075, edge_period = 8.0;                 // of table_edge [m], [s]
constexpr double rotation_period = 20.0, rotation_radius = 0.12;         // the camera is held before the body
constexpr double step_length = 0.36, bob_up = 0.014, bob_aside = 0.012;  // of a walker [m]

Vector3d rotated_eye(const Vector3d& centre, double azimuth, double elevation, double radius) {
  return centre + radius * Vector3d(std::sin(azimuth) * std::cos(elevation), -std::cos(azimuth) * std::cos(elevation),
                                    std::sin(elevation));
}

/// Angle of all turns at a time [rad].
double turned(const std::vector<Turn>& turns, double time) {
  double angle = 0.0;
  for (const Turn& turn : turns) {
    constexpr double largest_slope = 1.5;  // of smoothstep
    const double duration = largest_slope * std::abs(turn.angle) / turn.rate;
    const double t = duration > 0.0 ? std::clamp((time - turn.begin) / duration, 0.0, 1.0) : 0.0;
    angle += turn.angle * t * t * (3.0 - 2.0 * t);
  }
  return angle;
}

std::optional<WaypointPath> walk_of(PathKind kind, const Stage& stage) {
  if (kind == PathKind::loop) return WaypointPath(stage.loop);
  if (kind == PathKind::corridor) return WaypointPath(stage.corridor);
  if (kind == PathKind::square) return WaypointPath(stage.square);
  return std::nullopt;
}
}  // namespace

const char* to_string(PathKind kind) {
  for (const auto& [known, name] : path_kinds)
    if (known == kind) return name;
  return "drive";
}

std::vector<std::string> path_names(bool of_stage_alone) {
  std::vector<std::string> names;
  for (const auto& [kind, name] : path_kinds)
    if (kind != PathKind::waypoints || !of_stage_alone) names.emplace_back(name);
  return names;
}

PathKind path_kind(const std::string& name) {
  std::string expected;
  for (const auto& [kind, known] : path_kinds) {
    if (name == known) return kind;
    expected += (expected.empty() ? "" : kind == PathKind::waypoints ? " or " : ", ") + std::string(known);
  }
  throw ConfigurationError(SourceLocation{}, "camera path '" + name + "' is not known; expected " + expected);
}

Eigen::Isometry3d look_at(const Vector3d& eye, const Vector3d& target) {
  HOLDFAST_CHECK((target - eye).head<2>().norm() > 1e-6, "target " << target.transpose() << " eye " << eye.transpose());
  const Vector3d forward = (target - eye).normalized();
  const Vector3d right = forward.cross(Vector3d::UnitZ()).normalized();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear().col(0) = right;
  pose.linear().col(1) = forward.cross(right);
  pose.linear().col(2) = forward;
  pose.translation() = eye;
  return pose;
}

CameraPath::CameraPath(PathKind kind, const Stage& stage, std::uint64_t seed, const PathStyle& style)
    : CameraPath(kind, stage, walk_of(kind, stage), seed, style) {
  HOLDFAST_CHECK(kind != PathKind::waypoints, "a path along waypoints needs them");
  HOLDFAST_CHECK(kind != PathKind::drive, "a drive needs a road");
}

CameraPath::CameraPath(const Waypoints& waypoints, std::uint64_t seed, const PathStyle& style)
    : CameraPath(PathKind::waypoints, Stage(), WaypointPath(waypoints), seed, style) {}

CameraPath::CameraPath(const RoadPlan& road, std::uint64_t seed, const PathStyle& style)
    : kind_(PathKind::drive), style_(style), course_(RoadCourse(road, seed)) {
  Random random = Random(seed).fork(0xd21);
  for (double& phase : phases_) phase = random.uniform(0.0, full_turn<double>);
  // A body on its springs sways between 1 and 2 Hz, and vibrates above.
  add_tremor(0.006, 0.0025, 1.0, style.shake, random);
}

CameraPath::CameraPath(PathKind kind, const Stage& stage, std::optional<WaypointPath> walk, std::uint64_t seed,
                       const PathStyle& style)
    : kind_(kind), stage_(stage), style_(style), walk_(std::move(walk)) {
  Random random = Random(seed).fork(0x9a7);
  for (double& phase : phases_) phase = random.uniform(0.0, full_turn<double>);
  // On the table's edge the hand rests.
  const double steadiness = kind == PathKind::table_edge ? 0.3 : 1.0;
  // A hand trembles most below 1 Hz.
  add_tremor(0.0035, 0.0045, 0.4, steadiness * style.shake, random);
}

// Amplitudes fall with frequency so that no frame jumps.
void CameraPath::add_tremor(double position, double rotation, double frequency, double factor, Random random) {
  for (int axis = 0; axis < 6; ++axis)
    for (int i = 0; i < 5; ++i) {
      const double own_frequency = random.uniform(frequency, frequency + 0.6) * (1.0 + 0.9 * i);
      const double size = (axis < 3 ? position : rotation) / (1.0 + i) * factor;
      tremors_[axis].push_back(
          {size * random.uniform(0.5, 1.0), own_frequency, random.uniform(0.0, full_turn<double>)});
    }
}

double CameraPath::cycle() const {
  if (walk_) return walk_->cycle() / style_.speed;
  if (kind_ == PathKind::table_edge) return edge_period / style_.speed;
  if (kind_ == PathKind::rotation) return rotation_period / style_.speed;
  return 20.0 / style_.speed;
}

Eigen::Isometry3d CameraPath::hand_pose(double t) const {
  const Vector3d &home = stage_.home, &target = stage_.target;
  const Stage::HalfSphere& sphere = stage_.half_sphere;
  const auto wave = [&](int phase, double period) { return std::sin(full_turn<double> * t / period + phases_[phase]); };
  Eigen::Isometry3d pose;
  switch (kind_) {
    case PathKind::xyz: {
      // One axis after the other comes to the fore.
      const auto swell = [&](int phase, double shift) {
        return 0.62 + 0.38 * std::cos(full_turn<double> * (t / 19.0 + shift) + phases_[3 + phase] * 0.1);
      };
      const Vector3d offset(0.42 * swell(0, 0.0) * wave(0, 6.1), 0.36 * swell(1, 1.0 / 3) * wave(1, 7.3),
                            0.30 * swell(2, 2.0 / 3) * wave(2, 5.3));
      pose = look_at(home, target);
      pose.translation() += offset;
      break;
    }
    case PathKind::halfsphere:
      pose = look_at(rotated_eye(target, sphere.azimuth_swing * wave(0, 13.0),
                                 sphere.elevation + sphere.elevation_swing * wave(1, 8.9),
                                 sphere.radius + sphere.radius_swing * wave(2, 7.7)),
                     target);
      break;
    case PathKind::rpy: {
      pose = look_at(home, target);
      const Eigen::Quaterniond rotation = Eigen::AngleAxisd(0.42 * wave(0, 7.9), Vector3d::UnitY()) *
                                          Eigen::AngleAxisd(0.28 * wave(1, 6.1), Vector3d::UnitX()) *
                                          Eigen::AngleAxisd(0.45 * wave(2, 6.9), Vector3d::UnitZ());
      pose.rotate(rotation);
      pose.translation() += 0.03 * Vector3d(wave(3, 4.1), wave(4, 5.3), wave(5, 4.7));
      break;
    }
    case PathKind::table_edge:
      pose = look_at(stage_.table_edge, stage_.table_edge_target);
      pose.translation().x() -= 0.5 * edge_stroke * std::cos(full_turn<double> * t / edge_period);
      break;
    case PathKind::rotation: {
      const double heading = 0.25 * full_turn<double> + full_turn<double> * t / rotation_period;
      const Vector3d out(std::cos(heading), std::sin(heading), 0.0);
      pose = look_along(stage_.spot + rotation_radius * out, heading, 0.2);
      break;
    }
    default:
      pose = look_at(home, target);
  }
  return pose;
}

Eigen::Isometry3d CameraPath::walk_pose(double t) const {
  Eigen::Isometry3d pose = walk_->pose(t);
  // The body rises with every step and sways with every other.
  const double steps = walk_->walked(t) / step_length;
  pose.translation() +=
      style_.shake * (bob_up * std::sin(full_turn<double> * steps + phases_[0]) * Vector3d::UnitZ() +
                      bob_aside * std::sin(0.5 * full_turn<double> * steps + phases_[1]) * pose.linear().col(0));
  return pose;
}

Eigen::Isometry3d CameraPath::drive_pose(double t) const {
  constexpr double height = 1.65, weave = 0.12, weave_period = 9.0;
  const double left = course_->lane() + weave * std::sin(full_turn<double> * t / weave_period + phases_[0]);
  const Eigen::Isometry3d T_world_road = course_->frame(course_->driven(t), left);
  const Vector3d eye = T_world_road * Vector3d(0.0, 0.0, height);
  return look_at(eye, eye + T_world_road.linear().col(0));
}

Eigen::Isometry3d CameraPath::pose(double time) const {
  const double hand_time = course_ ? time : eased(time), t = style_.speed * hand_time;
  Eigen::Isometry3d pose = course_ ? drive_pose(t) : walk_ ? walk_pose(t) : hand_pose(t);
  if (!style_.turns.empty())
    pose.linear() = Eigen::AngleAxisd(turned(style_.turns, time), Vector3d::UnitZ()).toRotationMatrix() * pose.linear();
  double shake[6] = {};
  for (int axis = 0; axis < 6; ++axis)
    for (const Tremor& tremor : tremors_[axis])
      shake[axis] += tremor.amplitude * std::sin(full_turn<double> * tremor.frequency * hand_time + tremor.phase);
  const Vector3d angles(shake[3], shake[4], shake[5]);
  const double angle = angles.norm();
  pose.translate(Vector3d(shake[0], shake[1], shake[2]));
  if (angle > 0.0) pose.rotate(Eigen::AngleAxisd(angle, angles / angle));
  return pose;
}

}  // namespace holdfast::simulation
