// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/map_io/map_info.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "holdfast/core/version.hpp"
#include "map_io/example_inertia.hpp"
#include "map_io/map_files.hpp"

namespace holdfast {
namespace {

using test::random_map;
using ::testing::HasSubstr;
using ::testing::Not;
using MapInfoTest = test::MapFileTest;

TEST_F(MapInfoTest, CountsWhatIsThere) {
  const Map map = random_map(16, 30, 1);
  write_map(path("map.hfm"), map);
  const MapInfo info = read_map_info(path("map.hfm"));
  EXPECT_EQ(info.file_size, std::filesystem::file_size(path("map.hfm")));
  EXPECT_EQ(info.format_version, 1U);
  EXPECT_EQ(info.made_by, HOLDFAST_VERSION);
  ASSERT_EQ(info.cameras.size(), 2U);
  Camera camera = *find_camera("tum_fr1");
  camera.readout = 0.0;
  EXPECT_EQ(info.cameras[0], camera);
  EXPECT_EQ(info.keyframes, map.keyframes().size());
  EXPECT_EQ(info.features, 30 * map.keyframes().size());
  EXPECT_EQ(info.points, map.points().size());
  EXPECT_EQ(info.loops, 2U);
  EXPECT_EQ(info.next_sequence, map.next_sequence());
  std::uint64_t observations = 0, edges = 0;
  double first = 1e300, last = 0;
  Eigen::Vector3d minimum = Eigen::Vector3d::Constant(1e9), maximum = -minimum;
  map.points().for_each([&](MapPointId, const MapPoint& point) {
    observations += point.observations.size();
    minimum = minimum.cwiseMin(point.position);
    maximum = maximum.cwiseMax(point.position);
  });
  map.keyframes().for_each([&](KeyFrameId, const KeyFrame& keyframe) {
    edges += keyframe.covisible.size();
    first = std::min(first, keyframe.frame.timestamp);
    last = std::max(last, keyframe.frame.timestamp);
  });
  EXPECT_EQ(info.observations, observations);
  EXPECT_EQ(info.covisibility_edges, edges / 2);
  EXPECT_EQ(info.first_timestamp, first);
  EXPECT_EQ(info.last_timestamp, last);
  EXPECT_EQ(info.minimum_point, minimum);
  EXPECT_EQ(info.maximum_point, maximum);
}

TEST_F(MapInfoTest, TextAndJson) {
  Map map = random_map(10, 30, 2);
  write_map(path("map.hfm"), map);
  MapInfo info = read_map_info(path("map.hfm"));
  EXPECT_THAT(to_text(info), HasSubstr("\nkeyframes  " + std::to_string(info.keyframes) + ", "));
  EXPECT_THAT(to_text(info), HasSubstr("\ncamera     tum_fr1, 640x480"));
  info.file = "a \"quoted\"\\name\n";
  const auto json = nlohmann::json::parse(to_json(info));
  EXPECT_EQ(json["file"], info.file);
  EXPECT_EQ(json["points"], info.points);
  EXPECT_EQ(json["cameras"][0]["fx"], info.cameras[0].fx);
  EXPECT_EQ(json["first_timestamp"], info.first_timestamp);
  EXPECT_EQ(json["maximum_point"][2], info.maximum_point.z());
  info.file = "caf\xe9 caf\xc3\xa9 \xed\xa0\x80 \xf0\x9f\x98\x80 \xf0\x9f";
  EXPECT_EQ(
      nlohmann::json::parse(to_json(info))["file"],
      "caf\xef\xbf\xbd caf\xc3\xa9 \xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd \xf0\x9f\x98\x80 \xef\xbf\xbd\xef\xbf\xbd");
  write_map(path("empty.hfm"), Map());
  EXPECT_EQ(nlohmann::json::parse(to_json(read_map_info(path("empty.hfm"))))["keyframes"], 0);
  EXPECT_THAT(to_text(read_map_info(path("empty.hfm"))), HasSubstr("keyframes  0, "));
}

TEST_F(MapInfoTest, CountsClasses) {
  Map map = random_map(6, 20, 4);
  write_map(path("map.hfm"), map);
  EXPECT_THAT(to_text(read_map_info(path("map.hfm"))), Not(HasSubstr("classes")));
  EXPECT_TRUE(nlohmann::json::parse(to_json(read_map_info(path("map.hfm"))))["classes"].empty());

  map.set_classes({"background", "a \"cat\"\x1b[31m"});
  const std::vector<MapPointId> points = map.points().ids();
  map.point(points[0]).label = map.point(points[1]).label = 0;
  map.point(points[2]).label = 1;
  write_map(path("map.hfm"), map);
  const MapInfo info = read_map_info(path("map.hfm"));
  EXPECT_THAT(to_text(info), HasSubstr("\nclasses    \"background\" 2, \"a \\\"cat\\\"\\u001b[31m\" 1, unknown " +
                                       std::to_string(points.size() - 3) + "\n"));
  const auto json = nlohmann::json::parse(to_json(info));
  EXPECT_EQ(json["classes"]["background"], 2);
  EXPECT_EQ(json["classes"]["a \"cat\"\x1b[31m"], 1);
}

TEST_F(MapInfoTest, CountsVelocities) {
  Map map = random_map(7, 20, 5);
  write_map(path("map.hfm"), map);
  EXPECT_THAT(to_text(read_map_info(path("map.hfm"))), Not(HasSubstr("velocities")));
  test::add_motions(map);
  write_map(path("map.hfm"), map);
  EXPECT_THAT(to_text(read_map_info(path("map.hfm"))), HasSubstr("\nvelocities of 2 keyframes\n"));
  EXPECT_EQ(nlohmann::json::parse(to_json(read_map_info(path("map.hfm"))))["motions"], 2);
}

TEST_F(MapInfoTest, ShowsEstimatesOfAnImu) {
  Map map = random_map(4, 20, 5);
  write_map(path("map.hfm"), map);
  EXPECT_THAT(to_text(read_map_info(path("map.hfm"))), Not(HasSubstr("inertia")));
  EXPECT_TRUE(nlohmann::json::parse(to_json(read_map_info(path("map.hfm"))))["inertia"].is_null());
  map.set_inertia(test::example_inertia());
  write_map(path("map.hfm"), map);
  const MapInfo info = read_map_info(path("map.hfm"));
  EXPECT_THAT(to_text(info),
              HasSubstr("\ninertia    down is (0.16, -0.98, 0.08), biases of the gyroscope 0.0374 rad/s, "
                        "of the accelerometer 0.374 m/s^2\n"));
  EXPECT_EQ(nlohmann::json::parse(to_json(info))["inertia"]["accelerometer_bias"][2], -0.3);
}

/// Features are not decoded, yet their damage is seen.
TEST_F(MapInfoTest, SeesDamageAnywhere) {
  const std::string bytes = bytes_of(random_map(4, 20, 3));
  for (std::size_t i = 0; i < bytes.size(); i += 7) {
    std::string flipped = bytes;
    flipped[i] = static_cast<char>(flipped[i] ^ 0x10);
    write("flipped.hfm", flipped);
    ASSERT_THROW(read_map_info(path("flipped.hfm")), InputError) << "byte " << i;
  }
  EXPECT_THROW(read_map_info(path("nothing.hfm")), InputError);
}

}  // namespace
}  // namespace holdfast
