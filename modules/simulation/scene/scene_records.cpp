// SPDX-License-Identifier: BSD-3-Clause
#include "scene_records.hpp"

namespace holdfast::simulation {

namespace {

/// Coordinates are compared with the largest room, 20 m long, with space around it: time and memory grow with the ways
/// between places.
constexpr double farthest = 50.0;    // [m]
constexpr double longest = 36000.0;  // [s]

}  // namespace

void SceneRecord::describe(ParameterTable<SceneRecord>& table) {
  using S = SceneRecord;
  table.add("room", &S::room, "where it plays").one_of(room_names());
  table.add("duration", &S::duration, "length of the sequence").range(0.001, 36000.0).unit("s");
  table.add("frame_rate", &S::frame_rate, "frames per second").range(0.1, 1000.0).unit("1/s");
  table.add("seed", &S::seed, "of textures, small things, people, path and noise; 0 = the run's seed");
  table
      .add("visit", &S::visit,
           "number of the visit to the room: from 2 on, chairs stand elsewhere, screens show other pictures, and the "
           "camera's tremor and noise differ")
      .range(1, 1000000);
}

void RoadRecord::describe(ParameterTable<RoadRecord>& table) {
  using S = RoadRecord;
  table.add("kind", &S::kind, "a street with houses and parked cars, or a motorway").one_of(road_names()).required();
  table.add("speed", &S::speed, "mean speed of the camera's car; 0 = 10 in a street, 25 on a motorway")
      .range(0.0, 40.0)
      .unit("m/s");
  table.add("traffic", &S::traffic, "factor on the number of moving vehicles; 0 = none").range(0.0, 3.0);
  table.add("bends", &S::bends, "factor on the curvature; 0 = straight").range(0.0, 2.0);
}

void CameraRecord::describe(ParameterTable<CameraRecord>& table) {
  using S = CameraRecord;
  table.add("path", &S::path, "how the camera moves; waypoints: past the places in `along`").one_of(path_names(false));
  table.add("speed", &S::speed, "factor on the speed of the path").range(0.01, 10.0);
  table.add("shake", &S::shake, "factor on the tremor of the hand; 0 = none").range(0.0, 10.0);
  table
      .add("turns", &S::turns,
           "turns about the vertical on top of the path: [begin [s], angle to the left [degrees], largest rate "
           "[degrees/s]]")
      .range(-36000.0, 36000.0);
  table.add("along", &S::along, "waypoints: places [x, y, z] to pass").range(-farthest, farthest).unit("m");
  table.add("closed", &S::closed, "waypoints: from the last place on to the first; otherwise to and fro");
  table.add("walking_speed", &S::walking_speed, "waypoints: before the factor `speed`").range(0.01, 3.0).unit("m/s");
  table.add("look_at", &S::look_at, "waypoints: the place [x, y, z] to look at; otherwise along the way")
      .range(-farthest, farthest)
      .unit("m");
}

void PersonRecord::describe(ParameterTable<PersonRecord>& table) {
  using S = PersonRecord;
  table.add("name", &S::name, "what truth calls the person; empty = \"person\" and a number");
  table.add("at", &S::at, "place [x, y] where the person begins").range(-farthest, farthest).unit("m").required();
  table.add("facing", &S::facing, "place [x, y] the person looks to at first; empty = where the first action leads")
      .range(-farthest, farthest)
      .unit("m");
  table.add("height", &S::height, "0 = chosen by the seed").range(0.0, 2.3).unit("m");
  table.add("girth", &S::girth, "breadth as a factor on the average for the height; 0 = chosen by the seed")
      .range(0.0, 2.0);
  table.add("start", &S::start, "stands still until then; below 0 = has begun that long before the first frame")
      .range(-36000.0, 36000.0)
      .unit("s");
  table.add("repeat", &S::repeat, "begins anew after the last action; otherwise stays there, standing");
}

void WalkRecord::describe(ParameterTable<WalkRecord>& table) {
  using S = WalkRecord;
  table.add("to", &S::to, "places [x, y] to walk past, the last one to stop at")
      .range(-farthest, farthest)
      .unit("m")
      .required();
  table.add("speed", &S::speed, "of walking").range(0.1, 3.0).unit("m/s");
}

void StandRecord::describe(ParameterTable<StandRecord>& table) {
  using S = StandRecord;
  table.add("for", &S::duration, "how long").range(0.01, 36000.0).unit("s");
  table.add("gesture", &S::gesture, "talks with the hands");
  table.add("facing", &S::facing, "place [x, y] to turn to first; empty = as before")
      .range(-farthest, farthest)
      .unit("m");
}

void SitRecord::describe(ParameterTable<SitRecord>& table) {
  using S = SitRecord;
  table.add("on", &S::on, "name of a chair, such as \"chair 1\"").required();
  table.add("for", &S::duration, "how long, from sitting to rising").range(0.01, 36000.0).unit("s");
  table.add("gesture", &S::gesture, "talks with the hands");
}

void PushRecord::describe(ParameterTable<PushRecord>& table) {
  using S = PushRecord;
  table.add("thing", &S::thing, "name of a thing on the floor, such as \"chair 2\"").required();
  table.add("to", &S::to, "places [x, y] to push it past, the last one to leave it at")
      .range(-farthest, farthest)
      .unit("m")
      .required();
  table.add("speed", &S::speed, "of walking").range(0.1, 3.0).unit("m/s");
}

void CarryRecord::describe(ParameterTable<CarryRecord>& table) {
  using S = CarryRecord;
  table.add("thing", &S::thing, "name of a thing, such as \"box 5\"").required();
  table.add("to", &S::to, "places [x, y] that the person walks past with it, the last one to stop at")
      .range(-farthest, farthest)
      .unit("m")
      .required();
  table.add("put_at", &S::put_at, "place [x, y, z] to put it down at").range(-farthest, farthest).unit("m").required();
  table.add("speed", &S::speed, "of walking").range(0.1, 3.0).unit("m/s");
}

void SwingPlan::describe(ParameterTable<SwingPlan>& table) {
  using S = SwingPlan;
  table.add("thing", &S::thing, "name of a door");
  table.add("angle", &S::angle, "how far it opens").range(0.01, 3.0).unit("rad");
  table.add("start", &S::start, "begins to open").range(0.0, longest).unit("s");
  table.add("opening", &S::opening, "time to open, and to close").range(0.1, 60.0).unit("s");
  table.add("open", &S::open, "stays open").range(0.0, longest).unit("s");
  table.add("shut", &S::shut, "stays shut before it opens again").range(0.0, longest).unit("s");
}

void ColourSensorSettings::describe(ParameterTable<ColourSensorSettings>& table) {
  using S = ColourSensorSettings;
  table.add("noise", &S::noise, "standard deviation of each colour value; 0 = none")
      .range(0.0, 64.0)
      .unit("grey levels");
  table
      .add("exposure_change", &S::exposure_change,
           "how far the exposure wanders: gain up to 1 + this, down to 1 / that; 0 = constant")
      .range(0.0, 1.0);
  table.add("exposure_period", &S::exposure_period, "of the exposure's swings").range(0.1, 1000.0).unit("s");
  table.add("vignetting", &S::vignetting, "share of the light that is lost in the corners").range(0.0, 1.0);
  table.add("shutter", &S::shutter, "how long it is open, which blurs what moves; 0 = sharp").range(0.0, 0.5).unit("s");
}

void DepthSensorSettings::describe(ParameterTable<DepthSensorSettings>& table) {
  using S = DepthSensorSettings;
  table.add("noise", &S::noise, "factor on a Kinect's depth noise; 0 = none").range(0.0, 10.0);
  table.add("quantisation", &S::quantisation, "round disparity to eighths of a pixel, as a Kinect does");
  table.add("holes", &S::holes, "no depth in the projector's shadow and on surfaces seen flat");
  table.add("edge_holes", &S::edge_holes, "widest band without depth along depth edges, rolling on with time; 0 = none")
      .range(0.0, 16.0)
      .unit("px");
  table.add("dropout", &S::dropout, "share of pixels without depth by chance").range(0.0, 1.0);
  table.add("minimum_depth", &S::minimum_depth, "no depth nearer").range(0.0, 100.0).unit("m");
  table.add("maximum_depth", &S::maximum_depth, "no depth farther").range(0.1, 100.0).unit("m");
}

void LightsOutRecord::describe(ParameterTable<LightsOutRecord>& table) {
  using S = LightsOutRecord;
  table.add("from", &S::from, "the light goes out").range(0.0, longest).unit("s").required();
  table.add("to", &S::to, "the light is back").range(0.0, longest).unit("s").required();
}

}  // namespace holdfast::simulation
