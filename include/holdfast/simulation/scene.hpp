// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/core/random.hpp"
#include "holdfast/simulation/camera_path.hpp"
#include "holdfast/simulation/plan.hpp"
#include "holdfast/simulation/road.hpp"
#include "holdfast/simulation/room.hpp"
#include "holdfast/simulation/sensor.hpp"

namespace holdfast::simulation {

/// An interval without light, in which the colour image contains noise only. Depth is not affected, because its sensor
/// has its own light.
struct LightsOut {
  double from = 0.0;  ///< [s]
  double to = 0.0;    ///< [s]
};

/// The camera path of a scene.
struct CameraPlan {
  PathKind path = PathKind::xyz;
  PathStyle style;
  Waypoints waypoints;  ///< for PathKind::waypoints
};

/// Description of a simulated sequence: a room with moving people and objects, or a road; the camera path and the
/// sensors.
struct Scene {
  std::string name = "empty";
  std::string file;                    ///< path of the scene file, for messages and records; empty = none
  std::vector<std::string> overrides;  ///< overrides of the file's values, for records
  RoomKind room = RoomKind::office;
  std::optional<RoadPlan> road;  ///< in place of the room; without people and doors
  CameraPlan camera;
  double duration = 20.0;    ///< [s]; frames from 0 up to, not including, this time
  double frame_rate = 30.0;  ///< [1/s]
  /// Number of the visit to the room: from 2 on, chairs stand elsewhere and screens show other pictures (rearrange()),
  /// and the camera's tremor and noise differ.
  std::uint64_t visit = 1;
  std::uint64_t seed = 1;  ///< seed of textures, small objects, people, path and noise
  std::vector<PersonPlan> people;
  std::vector<SwingPlan> doors;
  std::vector<LightsOut> lights_out;
  DepthSensorSettings depth_sensor;
  ColourSensorSettings colour_sensor;

  /// Seed of what differs between visits: that of the scene on the first one.
  std::uint64_t visit_seed() const { return visit <= 1 ? seed : Random(seed).fork(0x7152).fork(visit).next(); }
  /// Name of the kind of road or room.
  std::string place_name() const { return road ? to_string(road->kind) : to_string(room); }
};

/// The camera path of a scene. `stage` is that of its world.
CameraPath make_path(const Scene& scene, const Stage& stage);

}  // namespace holdfast::simulation
