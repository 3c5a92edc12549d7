// SPDX-License-Identifier: BSD-3-Clause
#include "inertial_problem.hpp"

#include <cmath>
#include <limits>

#include "holdfast/core/random.hpp"

namespace holdfast::conformance {

namespace {

using geometry::Preintegration;

constexpr std::uint32_t pose_count = 8;
constexpr int samples_per_pose = 50;
constexpr double interval = 0.005;  // [s]

Eigen::Vector3d vector(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

Eigen::Isometry3d turned(const Eigen::Isometry3d& pose, Random& random, double metres, double radians) {
  geometry::Vector6d tangent;
  tangent << vector(random, metres), vector(random, radians);
  return geometry::exp_se3(tangent) * pose;
}

/// A body that swings: its state after each sample, and the true measurements that lead there.
class Swing {
 public:
  Swing(Random& random, const Eigen::Vector3d& gravity, const geometry::InertialState& state)
      : gravity_(gravity), state_(state), turn_(vector(random, 0.8)), push_(vector(random, 1.5)) {}

  const geometry::InertialState& state() const { return state_; }
  /// Moves on by `samples`; `measured` gets the measurements with the biases of the state.
  void move(int samples, Preintegration& measured) {
    for (int i = 0; i < samples; ++i, time_ += interval) {
      const Eigen::Vector3d rate = turn_ * std::cos(2.0 * time_);
      const Eigen::Vector3d acceleration = push_ * std::cos(3.0 * time_ + 1.0);
      const Eigen::Vector3d force = state_.T_world_body.linear().transpose() * (acceleration - gravity_);
      Preintegration step({}, state_.bias);
      step.integrate(rate + state_.bias.gyroscope, force + state_.bias.accelerometer, interval);
      measured.integrate(rate + state_.bias.gyroscope, force + state_.bias.accelerometer, interval);
      state_ = step.predict(state_, gravity_);
    }
  }

 private:
  Eigen::Vector3d gravity_;
  geometry::InertialState state_;
  Eigen::Vector3d turn_, push_;
  double time_ = 0.0;
};

void add_observations(KnownInertial& known, Random& random) {
  BundleProblem& problem = known.problem;
  for (std::uint32_t k = 0; k < 80; ++k) {
    const Eigen::Vector3d point(random.uniform(-1.0, 1.0), random.uniform(-0.8, 0.8), random.uniform(2.5, 4.5));
    problem.points.push_back(point + vector(random, 0.01));
    for (std::uint32_t i = 0; i < pose_count; ++i) {
      const Eigen::Vector3d seen = known.poses[i] * point;
      if ((i >= first_hidden_pose && i <= last_hidden_pose) || seen.z() < 0.5) continue;
      const Eigen::Vector2d pixel = problem.camera->project(seen);
      problem.observations.push_back({.pose = i,
                                      .point = k,
                                      .x = static_cast<float>(pixel.x()),
                                      .y = static_cast<float>(pixel.y()),
                                      .right_x = static_cast<float>(problem.camera->right_x(pixel.x(), seen.z()))});
    }
  }
}

}  // namespace

KnownInertial known_inertial(const Camera& camera, std::uint64_t seed, double scale) {
  Random random(seed + 300);
  KnownInertial known;
  BundleProblem& problem = known.problem;
  BundleFactors& factors = problem.factors;
  problem.camera = &camera;
  known.gravity =
      turned(Eigen::Isometry3d::Identity(), random, 0.0, 0.3).linear() * Eigen::Vector3d(0.0, standard_gravity, 0.0);
  known.bias = {vector(random, 0.01), vector(random, 0.05)};
  factors.T_body_camera = turned(Eigen::Isometry3d::Identity(), random, 0.05, 1.0);
  factors.gravity = turned(Eigen::Isometry3d::Identity(), random, 0.0, 0.01).linear() * known.gravity;
  factors.scale = scale;
  geometry::InertialState state;
  state.T_world_body = factors.T_body_camera.inverse();
  state.bias = known.bias;
  Swing swing(random, known.gravity, state);
  for (std::uint32_t i = 0; i < pose_count; ++i) {
    Eigen::Isometry3d T_world_camera = swing.state().T_world_body * factors.T_body_camera;
    T_world_camera.translation() /= scale;
    known.poses.push_back(T_world_camera.inverse());
    known.velocities.push_back(swing.state().velocity);
    const bool is_hidden = i >= first_hidden_pose && i <= last_hidden_pose;
    const double error = i == 0 ? 0.0 : is_hidden ? 0.05 : 0.01;
    problem.poses.push_back({turned(known.poses[i], random, error, 0.5 * error), i == 0});
    factors.motions.push_back({i, swing.state().velocity + vector(random, 0.2), {}});
    Preintegration measured;
    swing.move(samples_per_pose, measured);
    if (i + 1 < pose_count) factors.inertial.push_back({i, i + 1, measured});
  }
  add_observations(known, random);
  return known;
}

}  // namespace holdfast::conformance
