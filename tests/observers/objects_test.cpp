// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "holdfast/interfaces/observer.hpp"
#include "holdfast/plugin/registry.hpp"

extern "C" void holdfast_register_plugin_objects(holdfast::Registry&);

namespace holdfast {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> lines_of(const fs::path& file) {
  std::ifstream stream(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

class ObjectsTest : public testing::Test {
 protected:
  void SetUp() override {
    holdfast_register_plugin_objects(registry_);
    folder_ = fs::path(testing::TempDir()) / ("holdfast_objects_" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::vector<std::string> watch(const ParameterValues& values) const {
    CreationContext context;
    context.output_directory = folder_;
    const auto observer = registry_.create<Observer>("objects", values, context);
    FrameResult result;
    result.timestamp = 1.5;
    observer->on_frame({}, {}, result);
    MovingObject object;
    object.id = 4;
    object.class_name = "person";
    object.T_world_object.translation() = Eigen::Vector3d(1, 2, 3);
    object.velocity = Eigen::Vector3d(0.5, 0, -0.25);
    object.box = Eigen::AlignedBox3f(Eigen::Vector3f(-1, -2, -3), Eigen::Vector3f(1, 2, 3));
    object.moving = true;
    object.last_seen = result.timestamp = 2.0;
    result.objects = {object};
    observer->on_frame({}, {}, result);
    result.timestamp = 2.1;  // hidden
    observer->on_frame({}, {}, result);
    observer->on_finish(Map());
    return lines_of(folder_ / "objects.csv");
  }

  Registry registry_;
  fs::path folder_;
};

TEST_F(ObjectsTest, WritesALineForEachObjectThatAFrameShows) {
  const std::vector<std::string> lines = watch({});
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(std::count(lines[0].begin(), lines[0].end(), ','), std::count(lines[1].begin(), lines[1].end(), ','));
  EXPECT_THAT(lines[0], testing::StartsWith("timestamp,id,class,moving,x,y,z,qx,qy,qz,qw,vx,vy,vz,"));
  EXPECT_EQ(lines[1],
            "2.000000,4,person,1,1.0000,2.0000,3.0000,0.00000,0.00000,0.00000,1.00000,0.5000,0.0000,-0.2500,0.0000,"
            "-1.000,-2.000,-3.000,1.000,2.000,3.000,2.000000");
}

TEST_F(ObjectsTest, WritesHiddenObjectsWhenAsked) {
  const std::vector<std::string> lines = watch({{"hidden", true}});
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_THAT(lines[2], testing::StartsWith("2.100000,4,person,1,"));
  EXPECT_THAT(lines[2], testing::EndsWith(",2.000000"));
}

TEST_F(ObjectsTest, WritesNothingWithoutAnOutputFolder) {
  const auto observer = registry_.create<Observer>("objects", {}, {});
  observer->on_finish(Map());
  EXPECT_FALSE(fs::exists("objects.csv"));
}

}  // namespace
}  // namespace holdfast
