// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "holdfast/plugin/parameter_table.hpp"
#include "holdfast/simulation/scene.hpp"

/// The sections of a scene file as they stand in it, each with its parameter table. Scene holds the same in the types
/// that the simulator works with. (Doors and sensors have no record: their settings have tables themselves.)
namespace holdfast::simulation {

struct SceneRecord {
  std::string room = "office";
  double duration = Scene{}.duration;
  double frame_rate = Scene{}.frame_rate;
  std::uint64_t seed = 0;
  std::uint64_t visit = Scene{}.visit;
  static void describe(ParameterTable<SceneRecord>& table);
};

struct RoadRecord {
  std::string kind;
  double speed = RoadPlan{}.speed;
  double traffic = RoadPlan{}.traffic;
  double bends = RoadPlan{}.bends;
  static void describe(ParameterTable<RoadRecord>& table);
};

struct CameraRecord {
  std::string path = "xyz";
  double speed = PathStyle{}.speed;
  double shake = PathStyle{}.shake;
  RealTable turns;
  RealTable along;
  bool closed = false;
  double walking_speed = Waypoints{}.speed;
  std::vector<double> look_at;
  static void describe(ParameterTable<CameraRecord>& table);
};

struct PersonRecord {
  std::string name;
  std::vector<double> at;
  std::vector<double> facing;
  double height = 0.0;
  double girth = 0.0;
  double start = PersonPlan{}.start;
  bool repeat = PersonPlan{}.repeat;
  static void describe(ParameterTable<PersonRecord>& table);
};

struct WalkRecord {
  RealTable to;
  double speed = Walk{}.speed;
  static void describe(ParameterTable<WalkRecord>& table);
};

struct StandRecord {
  double duration = Stand{}.duration;
  bool gesture = Stand{}.gesture;
  std::vector<double> facing;
  static void describe(ParameterTable<StandRecord>& table);
};

struct SitRecord {
  std::string on;
  double duration = Sit{}.duration;
  bool gesture = Sit{}.gesture;
  static void describe(ParameterTable<SitRecord>& table);
};

struct PushRecord {
  std::string thing;
  RealTable to;
  double speed = Push{}.speed;
  static void describe(ParameterTable<PushRecord>& table);
};

struct CarryRecord {
  std::string thing;
  RealTable to;
  std::vector<double> put_at;
  double speed = Carry{}.speed;
  static void describe(ParameterTable<CarryRecord>& table);
};

struct LightsOutRecord {
  double from = 0.0;
  double to = 0.0;
  static void describe(ParameterTable<LightsOutRecord>& table);
};

}  // namespace holdfast::simulation
