// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/simulation/camera_path.hpp"
#include "holdfast/simulation/renderer.hpp"
#include "holdfast/simulation/room.hpp"
#include "holdfast/simulation/sensor.hpp"
#include "holdfast/simulation/world.hpp"

namespace holdfast::simulation {

/// What to simulate.
struct SimulationSettings {
  RoomKind room = RoomKind::office;
  PathKind path = PathKind::xyz;  ///< any but waypoints
  double duration = 20.0;         ///< [s]; frames from 0 up to, not including, this time
  double frame_rate = 30.0;       ///< [1/s]
  std::uint64_t seed = 1;         ///< of room, path and noise
  DepthSensorSettings depth_sensor;
  ColourSensorSettings colour_sensor;
};

/// A sequence from a simulated world with all its truth. Frames can be asked for in any order: each depends on
/// settings, camera and index alone, to the byte. Used by one thread.
class Simulator {
 public:
  /// Throws ConfigurationError when there would be no frame.
  Simulator(const SimulationSettings& settings, const Camera& camera);

  std::uint64_t frame_count() const { return frame_count_; }
  double timestamp(std::uint64_t index) const { return static_cast<double>(index) / settings_.frame_rate; }
  Eigen::Isometry3d T_world_camera(std::uint64_t index) const { return path_.pose(timestamp(index)); }
  /// The pose of every frame.
  Trajectory truth() const;

  /// The images as the sensors report them, with truth: the pose, object_mask (numbers of the things that move, counted
  /// from 1 in the order of World::objects; 0 = the static world) and class_labels (into class_names()).
  SensorFrame frame(std::uint64_t index);
  /// The same without sensor effects.
  RenderedFrame render(std::uint64_t index);

  const World& world() const { return room_.world; }
  const Stage& stage() const { return room_.stage; }
  const Camera& camera() const { return camera_; }
  const SimulationSettings& settings() const { return settings_; }
  const std::vector<std::string>& class_names() const { return class_names_; }

 private:
  SimulationSettings settings_;
  Camera camera_;
  Room room_;
  CameraPath path_;
  Renderer renderer_;
  std::uint64_t frame_count_ = 0;
  std::vector<std::string> class_names_;
  std::vector<std::uint8_t> mask_values_;   // by object id
  std::vector<std::uint8_t> class_values_;  // by object id
};

}  // namespace holdfast::simulation
