// SPDX-License-Identifier: BSD-3-Clause
// Frames per second of simulated scenes on one core, and the time to build their worlds.
#include <benchmark/benchmark.h>

#include <opencv2/core/utility.hpp>
#include <string>

#include "holdfast/simulation/room.hpp"
#include "holdfast/simulation/scene_file.hpp"
#include "holdfast/simulation/simulator.hpp"

namespace {

using namespace holdfast;
using namespace holdfast::simulation;

Scene scene_of(const std::string& name) {
  Scene scene = read_scene(std::string(HOLDFAST_SOURCE_DIR "/examples/scenes/") + name + ".yaml");
  scene.seed = 1;
  return scene;
}

/// Frames of a scene, far apart, one after the other, with all sensor effects; the rate is shown as items_per_second,
/// the share of the image that people and things cover as "covered". `people`: so many of the scene's.
void frames(benchmark::State& state, const char* name, std::size_t people, const char* camera, double shutter) {
  cv::setNumThreads(1);
  Scene scene = scene_of(name);
  scene.people.resize(people);
  scene.colour_sensor.shutter = shutter;
  Simulator simulator(scene, *find_camera(camera));
  std::uint64_t index = 0;
  double covered = 0.0;
  for (auto _ : state) {
    const SensorFrame frame = simulator.frame(index);
    state.PauseTiming();
    covered += cv::countNonZero(frame.truth->object_mask) / static_cast<double>(frame.depth.total());
    state.ResumeTiming();
    index = (index + 37) % simulator.frame_count();
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()));
  state.counters["covered"] = covered / static_cast<double>(state.iterations());
}
BENCHMARK_CAPTURE(frames, empty, "empty", 0, "tum_fr3", 0.0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frames, empty_distorted, "empty", 0, "tum_fr1", 0.0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frames, three_people, "walking_xyz", 3, "tum_fr3", 0.0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frames, three_people_distorted, "walking_xyz", 3, "tum_fr1", 0.0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frames, three_people_blurred_10_ms, "walking_xyz", 3, "tum_fr3", 0.01)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frames, six_people_distorted, "crowd", 6, "tum_fr1", 0.0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frames, loop_distorted, "loop", 0, "tum_fr1", 0.0)->Unit(benchmark::kMillisecond);

void build_room(benchmark::State& state, RoomKind kind) {
  for (auto _ : state) benchmark::DoNotOptimize(make_room(kind, 1).world.objects.size());
}
BENCHMARK_CAPTURE(build_room, office, RoomKind::office)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(build_room, hall, RoomKind::hall)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(build_room, corridor, RoomKind::corridor)->Unit(benchmark::kMillisecond);

void build_scene(benchmark::State& state) {
  const Scene scene = scene_of("walking_xyz");
  for (auto _ : state) benchmark::DoNotOptimize(make_scene_world(scene).numbered.size());
}
BENCHMARK(build_scene)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
