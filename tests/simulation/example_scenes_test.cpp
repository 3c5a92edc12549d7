// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "holdfast/simulation/camera_path.hpp"
#include "holdfast/simulation/scene_file.hpp"
#include "holdfast/simulation/scene_world.hpp"

namespace holdfast::simulation {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

double distance_to_segment(const Vector3d& point, const Vector3d& from, const Vector3d& to) {
  const Vector3d along = to - from;
  const double share = std::clamp((point - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (point - from - share * along).norm();
}

std::vector<Scene> example_scenes(const std::string& room, std::uint64_t seed) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(fs::path(HOLDFAST_SOURCE_DIR) / "examples" / "scenes"))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<Scene> scenes;
  for (const fs::path& file : files) {
    Scene scene = read_scene(file, {"seed=" + std::to_string(seed)});
    if (scene.place_name() == room) scenes.push_back(std::move(scene));
  }
  return scenes;
}

class ExampleScenes : public testing::TestWithParam<const char*> {};

// Plays each example for three seeds and sees to it that nobody walks through the camera.
TEST_P(ExampleScenes, KeepPeopleOffTheCamera) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Room room = furnish_room(room_kind(GetParam()), seed);
    for (const Scene& scene : example_scenes(GetParam(), seed)) {
      SCOPED_TRACE(scene.name + ", seed " + std::to_string(seed));
      const SceneWorld world = make_scene_world(scene, room);
      const CameraPath path = scene.camera.path == PathKind::waypoints
                                  ? CameraPath(scene.camera.waypoints, scene.seed, scene.camera.style)
                                  : CameraPath(scene.camera.path, world.stage, scene.seed, scene.camera.style);
      ASSERT_GE(world.numbered.size(), scene.people.size() + scene.doors.size());
      double nearest = 1e9, nearest_time = 0.0;
      for (double time = 0.0; time < scene.duration; time += 0.2) {
        const Vector3d eye = path.pose(time).translation();
        EXPECT_TRUE(world.stage.walls.contains(eye)) << "camera at " << eye.transpose() << ", " << time << " s";
        for (std::size_t k = 0; k < scene.people.size(); ++k) {
          const Object& body = world.world.objects[world.numbered[k].index];
          const Eigen::Isometry3d pose = body.pose(time);
          const BonePoses bones = body.bones(time);
          const double distance = distance_to_segment(eye, pose * bones[index(Bone::pelvis)].translation(),
                                                      pose * bones[index(Bone::head)].translation());
          if (distance < nearest) nearest = distance, nearest_time = time;
          EXPECT_TRUE(world.stage.walls.contains(pose * Vector3d(0, 0, 1))) << body.name << ", " << time << " s";
        }
      }
      EXPECT_GE(nearest, 0.25) << "at " << nearest_time << " s";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Rooms, ExampleScenes, testing::Values("office", "hall", "corridor"),
                         [](const auto& room) { return std::string(room.param); });

}  // namespace
}  // namespace holdfast::simulation
