// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/core/trajectory.hpp"
#include "holdfast/geometry/preintegration.hpp"

/// Motions of a body with an IMU for tests: one in closed form, and a real flight.
namespace holdfast::geometry::inertial_motion {

inline const Eigen::Vector3d gravity(0, 0, -standard_gravity);

/// A smooth motion in closed form, as samples.
inline InertialState true_state(double t) {
  InertialState state;
  state.T_world_body.linear() = (Eigen::AngleAxisd(std::sin(2 * t), Eigen::Vector3d::UnitZ()) *
                                 Eigen::AngleAxisd(0.5 * t, Eigen::Vector3d::UnitX()))
                                    .toRotationMatrix();
  state.T_world_body.translation() << std::sin(3 * t), std::cos(2 * t), 0.3 * t * t;
  state.velocity << 3 * std::cos(3 * t), -2 * std::sin(2 * t), 0.6 * t;
  return state;
}
inline std::vector<ImuSample> true_samples(double begin, double end, double rate) {
  std::vector<ImuSample> samples;
  for (double t = begin; t <= end + 1e-9; t += 1.0 / rate) {
    const Eigen::Matrix3d turn = true_state(t).T_world_body.linear();
    const Eigen::Vector3d world_rate = 2 * std::cos(2 * t) * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d acceleration(-9 * std::sin(3 * t), -4 * std::cos(2 * t), 0.6);
    samples.push_back({t, turn.transpose() * world_rate + 0.5 * Eigen::Vector3d::UnitX(),
                       turn.transpose() * (acceleration - gravity)});
  }
  return samples;
}

struct RecordedFlight {
  std::vector<ImuSample> samples;
  std::vector<TimedPose> body;  ///< T_world_body
  Eigen::Isometry3d T_body_camera = Eigen::Isometry3d::Identity();
};

inline RecordedFlight read_flight(const std::filesystem::path& folder) {
  RecordedFlight flight;
  std::ifstream file(folder / "imu0.csv");
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    ImuSample sample;
    long long stamp = 0;
    double* const numbers[] = {&sample.angular_velocity[0], &sample.angular_velocity[1], &sample.angular_velocity[2],
                               &sample.acceleration[0],     &sample.acceleration[1],     &sample.acceleration[2]};
    const char* at = line.c_str();
    char* next = nullptr;
    stamp = std::strtoll(at, &next, 10);
    for (double* number : numbers) *number = std::strtod(next + 1, &next);
    sample.timestamp = static_cast<double>(stamp) * 1e-9;
    flight.samples.push_back(sample);
  }
  Eigen::Isometry3d& T_body_camera = flight.T_body_camera;  // of sensor.yaml
  T_body_camera.matrix().topRows<3>() << 0.0148655429818, -0.999880929698, 0.00414029679422, -0.0216401454975,
      0.999557249008, 0.0149672133247, 0.025715529948, -0.064676986768, -0.0257744366974, 0.00375618835797,
      0.999660727178, 0.00981073058949;
  for (const TimedPose& pose : read_trajectory(folder / "groundtruth_cam0.txt")) {
    // The file has the position of the camera in the world, but the rotation from the world to the camera.
    Eigen::Isometry3d T_world_camera = pose.T_world_camera;
    T_world_camera.linear().transposeInPlace();
    flight.body.push_back({pose.timestamp, T_world_camera * T_body_camera.inverse()});
  }
  return flight;
}

/// The folder of EuRoC V1_01 without images; empty without it.
inline std::optional<std::filesystem::path> flight_folder() {
  const char* data = std::getenv("HOLDFAST_DATA");
  if (data == nullptr) return std::nullopt;
  const std::filesystem::path folder = std::filesystem::path(data) / "euroc_v101_imu";
  if (!std::filesystem::exists(folder)) return std::nullopt;
  return folder;
}

}  // namespace holdfast::geometry::inertial_motion
