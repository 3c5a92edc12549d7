// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/map_io/map_export.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "json_text.hpp"
#include "map_io/example_inertia.hpp"
#include "map_io/map_files.hpp"

namespace holdfast {
namespace {

using test::number_at;
using test::random_map;
using MapExport = test::MapFileTest;

/// Reads the header as a viewer does: properties by name, all of four bytes.
struct Ply {
  explicit Ply(const std::string& text) {
    std::istringstream stream(text);
    std::string line, word, type, name;
    std::getline(stream, line);
    EXPECT_EQ(line, "ply");
    std::getline(stream, line);
    EXPECT_EQ(line, "format binary_little_endian 1.0");
    while (std::getline(stream, line) && line != "end_header") {
      std::istringstream words(line);
      words >> word >> type >> name;
      if (word == "element") vertices = std::stoul(name);
      if (word == "property") types.push_back(type), names.push_back(name);
    }
    data = text.substr(static_cast<std::size_t>(stream.tellg()));
    EXPECT_EQ(data.size(), vertices * names.size() * 4);
  }
  template <class T>
  T value(std::size_t vertex, const std::string& name) const {
    const auto found = std::find(names.begin(), names.end(), name) - names.begin();
    EXPECT_EQ(types.at(static_cast<std::size_t>(found)), (std::is_same_v<T, float> ? "float" : "int"));
    return number_at<T>(data, (vertex * names.size() + static_cast<std::size_t>(found)) * 4);
  }
  std::size_t vertices = 0;
  std::vector<std::string> types, names;
  std::string data;
};

TEST_F(MapExport, PointsAsPly) {
  const Map map = random_map(10, 30, 1);
  write_points_ply(path("points.ply"), map);
  const Ply ply(content(path("points.ply")));
  ASSERT_EQ(ply.vertices, map.points().size());
  std::size_t i = 0;
  map.points().for_each([&](MapPointId, const MapPoint& point) {
    EXPECT_EQ(ply.value<float>(i, "x"), static_cast<float>(point.position.x()));
    EXPECT_EQ(ply.value<float>(i, "z"), static_cast<float>(point.position.z()));
    EXPECT_EQ(ply.value<float>(i, "ny"), static_cast<float>(-point.viewing_direction.y()));
    EXPECT_EQ(ply.value<int>(i, "observations"), static_cast<int>(point.observations.size()));
    EXPECT_EQ(ply.value<float>(i, "static_log_odds"), point.static_log_odds);
    ++i;
  });
  EXPECT_EQ(Ply(points_ply(Map())).vertices, 0U);
  EXPECT_THROW(write_points_ply(path("nowhere/points.ply"), map), InputError);
}

TEST_F(MapExport, TrajectoryByTime) {
  Map map = random_map(12, 20, 2);
  map.keyframe(map.keyframes().ids().back()).frame.timestamp = 5.0;
  const Trajectory trajectory = keyframe_trajectory(map);
  ASSERT_EQ(trajectory.size(), map.keyframes().size());
  EXPECT_EQ(trajectory.front().timestamp, 5.0);
  for (std::size_t i = 1; i < trajectory.size(); ++i) EXPECT_LE(trajectory[i - 1].timestamp, trajectory[i].timestamp);
  map.keyframes().for_each([&](KeyFrameId, const KeyFrame& keyframe) {
    const auto found = std::find_if(trajectory.begin(), trajectory.end(),
                                    [&](const TimedPose& pose) { return pose.timestamp == keyframe.frame.timestamp; });
    ASSERT_NE(found, trajectory.end());
    EXPECT_TRUE(found->T_world_camera.isApprox(keyframe.frame.T_world_camera(), 1e-12));
  });
}

TEST(JsonText, EscapesWhatWouldCommandATerminal) {
  const std::string name = "\x1b[31m\x7f\xc2\x9b caf\xc3\xa9 \xe9 \"quoted\"";
  map_io::JsonText json;
  json.quote(name);
  EXPECT_EQ(json.text(), "\"\\u001b[31m\\u007f\\u009b caf\xc3\xa9 \xef\xbf\xbd \\\"quoted\\\"\"");
  json.text().clear();
  json.quote(std::string(1, '\0'));
  EXPECT_EQ(json.text(), "\"\\u0000\"");
}

TEST_F(MapExport, AllAsJson) {
  write_map(path("map.hfm"), random_map(14, 30, 3));
  const Map map = read_map(path("map.hfm"));  // ids are positions
  const auto json = nlohmann::json::parse(map_json(map));
  EXPECT_EQ(json["next_sequence"], map.next_sequence());
  ASSERT_EQ(json["cameras"].size(), 2U);
  EXPECT_EQ(json["cameras"][0]["name"], "tum_fr1");
  ASSERT_EQ(json["keyframes"].size(), map.keyframes().size());
  std::size_t edges = 0;
  map.keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    const auto& entry = json["keyframes"][id.slot];
    EXPECT_EQ(entry["id"], id.slot);
    EXPECT_EQ(entry["sequence"], keyframe.sequence);
    EXPECT_EQ(entry["timestamp"], keyframe.frame.timestamp);
    EXPECT_EQ(entry["position"][0], keyframe.frame.T_world_camera().translation().x());
    const auto& q = entry["orientation"];
    EXPECT_TRUE(Eigen::Quaterniond(q[3], q[0], q[1], q[2])
                    .toRotationMatrix()
                    .isApprox(keyframe.frame.T_world_camera().linear(), 1e-9));
    EXPECT_EQ(entry["parent"].is_null(), !keyframe.parent.valid());
    if (keyframe.parent.valid()) {
      EXPECT_EQ(entry["parent"], keyframe.parent.slot);
    }
    edges += keyframe.covisible.size();
  });
  EXPECT_EQ(json["covisibility"].size(), edges / 2);
  for (const auto& edge : json["covisibility"]) {
    const auto& covisible = map.keyframe({edge[0].get<std::uint32_t>(), 0}).covisible;
    EXPECT_TRUE(std::any_of(covisible.begin(), covisible.end(), [&](const CovisibilityEdge& e) {
      return e.keyframe.slot == edge[1].get<std::uint32_t>() && e.weight == edge[2].get<int>();
    }));
  }
  EXPECT_EQ(json["loops"].size(), 2U);
  ASSERT_EQ(json["points"].size(), map.points().size());
  map.points().for_each([&](MapPointId id, const MapPoint& point) {
    const auto& entry = json["points"][id.slot];
    EXPECT_EQ(entry["position"][1], point.position.y());
    EXPECT_EQ(entry["static_log_odds"].get<float>(), point.static_log_odds);
    ASSERT_EQ(entry["observations"].size(), point.observations.size());
    const Observation& last = point.observations.back();
    EXPECT_EQ(entry["observations"].back()[0], last.keyframe.slot);
    EXPECT_EQ(entry["observations"].back()[1], last.feature);
    EXPECT_EQ(entry["observations"].back()[2].get<float>(), map.keyframe(last.keyframe).frame.x[last.feature]);
  });
  EXPECT_TRUE(json["classes"].empty());
  EXPECT_FALSE(json["points"][0].contains("label"));
  EXPECT_EQ(nlohmann::json::parse(map_json(Map()))["points"].size(), 0U);

  Map classified = read_map(path("map.hfm"));
  classified.set_classes({"background", "person"});
  classified.point({0, 0}).label = 1;
  const auto with_classes = nlohmann::json::parse(map_json(classified));
  EXPECT_EQ(with_classes["classes"][1], "person");
  EXPECT_EQ(with_classes["points"][0]["label"], 1);
  EXPECT_TRUE(with_classes["points"][1]["label"].is_null());
  EXPECT_TRUE(with_classes["inertia"].is_null());
  classified.set_inertia(test::example_inertia());
  EXPECT_FALSE(with_classes["keyframes"][2].contains("velocity"));
  test::add_motions(classified);
  const auto keyframes = nlohmann::json::parse(map_json(classified))["keyframes"];
  EXPECT_EQ(keyframes[2]["velocity"][1], -0.2);
  EXPECT_EQ(keyframes[2]["accelerometer_bias"][2], 2.3);
  EXPECT_FALSE(keyframes[2].contains("vertical"));
  EXPECT_GT(keyframes[1]["vertical"][1], 0.9);
  EXPECT_EQ(nlohmann::json::parse(map_json(classified))["inertia"]["gravity"][1], -9.5);
}

}  // namespace
}  // namespace holdfast
