// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "holdfast/simulation/camera_path.hpp"
#include "holdfast/simulation/plan.hpp"
#include "holdfast/simulation/room.hpp"
#include "holdfast/simulation/sensor.hpp"

namespace holdfast::simulation {

/// The light goes out for a while: the colour camera sees noise. Depth, which brings its own light, goes on.
struct LightsOut {
  double from = 0.0;  ///< [s]
  double to = 0.0;    ///< [s]
};

/// The camera's way.
struct CameraPlan {
  PathKind path = PathKind::xyz;
  PathStyle style;
  Waypoints waypoints;  ///< of PathKind::waypoints
};

/// All that makes a simulated sequence: a room, who and what moves in it, the camera's way and its sensors.
struct Scene {
  std::string name = "empty";
  std::string file;  ///< that it was read from, for messages; empty = none
  RoomKind room = RoomKind::office;
  CameraPlan camera;
  double duration = 20.0;    ///< [s]; frames from 0 up to, not including, this time
  double frame_rate = 30.0;  ///< [1/s]
  std::uint64_t seed = 1;    ///< of textures, small things, people, path and noise
  std::vector<PersonPlan> people;
  std::vector<SwingPlan> doors;
  std::vector<LightsOut> lights_out;
  DepthSensorSettings depth_sensor;
  ColourSensorSettings colour_sensor;
};

}  // namespace holdfast::simulation
