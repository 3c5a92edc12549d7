// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "holdfast/interfaces/observer.hpp"
#include "holdfast/plugin/registry.hpp"
#include "mcap_file.hpp"

extern "C" void holdfast_register_plugin_mcap(holdfast::Registry&);

namespace holdfast {
namespace {

namespace fs = std::filesystem;
using rosbag_plugin::McapFile;
using testing::HasSubstr;
using testing::IsEmpty;
using Json = nlohmann::json;

class McapTest : public testing::Test {
 protected:
  void SetUp() override {
    holdfast_register_plugin_mcap(registry_);
    folder_ = fs::path(testing::TempDir()) / ("holdfast_mcap_" + std::to_string(getpid()));
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::unique_ptr<Observer> observer(const ParameterValues& values = {}) const {
    CreationContext context;
    context.output_directory = folder_;
    return registry_.create<Observer>("mcap", values, context);
  }

  /// A frame at `index` tenths of a second after 1.5 s, with an object from the second one on.
  static void feed(Observer& observer, std::uint64_t index) {
    SensorFrame sensor_frame;
    sensor_frame.index = index;
    sensor_frame.colour = cv::Mat(24, 32, CV_8UC3, cv::Scalar(10, 200, 30));
    FrameResult result;
    result.index = index;
    result.timestamp = 1.5 + 0.1 * static_cast<double>(index);
    result.status = TrackingStatus::tracked;
    result.T_world_camera = Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, static_cast<double>(index)));
    if (index > 0) {
      MovingObject object;
      object.id = 7;
      object.class_name = "person";
      object.moving = true;
      object.velocity = Eigen::Vector3d(0.0, 0.0, 2.0);
      object.box = Eigen::AlignedBox3f(Eigen::Vector3f(-1, -2, -3), Eigen::Vector3f(1, 2, 3));
      result.objects = {object};
    }
    observer.on_frame(sensor_frame, {}, result);
  }

  /// The messages by topic, as a strict reader finds them.
  static std::map<std::string, std::vector<Json>> read(const fs::path& file, Warnings* warnings = nullptr) {
    McapFile bag(file, file);
    std::map<std::string, std::vector<Json>> found;
    for (const auto& [number, connection] : bag.connections())
      for (const rosbag_plugin::BagMessage& message : connection.messages) {
        const rosbag_plugin::Bytes bytes = bag.read(message, ~std::uint64_t{0});
        found[connection.topic].push_back(Json::parse(bytes.begin(), bytes.end()));
      }
    if (warnings != nullptr) *warnings = bag.warnings();
    return found;
  }

  Registry registry_;
  fs::path folder_;
};

TEST_F(McapTest, WritesWhatARunFinds) {
  const auto writer = observer({{"image_every", std::int64_t{2}}});
  for (std::uint64_t i = 0; i < 3; ++i) feed(*writer, i);
  Map map;
  map.add_point(Eigen::Vector3d(1, 2, 3), 0);
  writer->on_finish(map);

  Warnings warnings;
  const auto found = read(folder_ / "run.mcap", &warnings);
  EXPECT_THAT(warnings, IsEmpty());
  ASSERT_EQ(found.at("/status").size(), 3U);
  EXPECT_EQ(found.at("/status")[1]["timestamp"], Json({{"sec", 1}, {"nsec", 600000000}}));
  EXPECT_EQ(found.at("/status")[1]["status"], "tracked");
  ASSERT_EQ(found.at("/camera/pose").size(), 3U);
  EXPECT_EQ(found.at("/camera/pose")[2]["pose"]["position"]["z"], 2.0);
  EXPECT_EQ(found.at("/tf").size(), 6U);
  EXPECT_EQ(found.at("/camera/image").size(), 2U);
  EXPECT_THAT(found.at("/camera/image")[0]["data"].get<std::string>(), testing::StartsWith("/9j/"));  // JPEG
  ASSERT_EQ(found.at("/objects").size(), 2U);
  const Json& entity = found.at("/objects")[0]["entities"][0];
  EXPECT_EQ(entity["texts"][0]["text"], "person 7");
  EXPECT_EQ(entity["cubes"][0]["size"]["z"], 6.0);
  EXPECT_EQ(entity["arrows"][0]["shaft_length"], 2.0);
  ASSERT_EQ(found.at("/map/points").size(), 1U);
  const Json& cloud = found.at("/map/points")[0];
  EXPECT_EQ(cloud["data"], "AACAPwAAAEAAAEBA");  // 1, 2, 3 as float32
  EXPECT_EQ(cloud["fields"][2]["offset"], 8);
}

TEST_F(McapTest, GivesEverySchemaItsFields) {
  const auto writer = observer();
  feed(*writer, 0);
  writer->on_finish(Map());
  std::ifstream stream(folder_ / "run.mcap", std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(stream)), {});
  for (const char* name : {"FrameTransform", "SceneUpdate", "CompressedImage", "PosesInFrame", "PointCloud"}) {
    const std::string begin =
        std::string("{\"title\":\"foxglove.") + name + "\",\"type\":\"object\",\"properties\":{\"";
    EXPECT_THAT(bytes, HasSubstr(begin));
  }
  EXPECT_THAT(bytes, HasSubstr("\"data\":{\"type\":\"string\",\"contentEncoding\":\"base64\"}"));
  EXPECT_THAT(bytes, HasSubstr("\"poses\":{\"type\":\"array\",\"items\":{\"type\":\"object\""));
}

TEST_F(McapTest, LeavesAReadableFileWhenTheRunIsKilled) {
  std::size_t frames = 0;
  {
    const auto writer = observer();
    while (!fs::exists(folder_ / "run.mcap") || fs::file_size(folder_ / "run.mcap") < (1U << 20))
      feed(*writer, ++frames);
    fs::copy_file(folder_ / "run.mcap", folder_ / "killed.mcap");
  }
  Warnings warnings;
  const auto found = read(folder_ / "killed.mcap", &warnings);
  EXPECT_EQ(warnings.size(), 1U);
  EXPECT_GT(found.at("/status").size(), frames / 2);
}

TEST_F(McapTest, WritesNothingWithoutAFolderAndSaysWhyItCannotWrite) {
  CreationContext context;
  const auto silent = registry_.create<Observer>("mcap", {}, context);
  feed(*silent, 0);
  silent->on_finish(Map());
  EXPECT_FALSE(fs::exists("run.mcap"));

  fs::create_directories(folder_ / "run.mcap");
  try {
    feed(*observer(), 0);
    FAIL() << "a folder was written to";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("run.mcap: cannot be written: "));
  }
}

}  // namespace
}  // namespace holdfast
