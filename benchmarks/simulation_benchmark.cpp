// SPDX-License-Identifier: BSD-3-Clause
#include <benchmark/benchmark.h>

#include <opencv2/core/utility.hpp>

#include "holdfast/simulation/room.hpp"
#include "holdfast/simulation/simulator.hpp"

namespace {

using namespace holdfast;
using namespace holdfast::simulation;

SimulationSettings settings_of(PathKind path) {
  SimulationSettings settings;
  settings.path = path;
  return settings;
}

/// Frames of a path, far apart, one after the other; the rate is shown as items_per_second.
void simulated_frames(benchmark::State& state, PathKind path, const char* camera, bool with_sensor) {
  cv::setNumThreads(1);
  Simulator simulator(settings_of(path), *find_camera(camera));
  std::uint64_t index = 0;
  for (auto _ : state) {
    if (with_sensor)
      benchmark::DoNotOptimize(simulator.frame(index).depth.data);
    else
      benchmark::DoNotOptimize(simulator.render(index).depth.data);
    index = (index + 37) % simulator.frame_count();
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()));
}
BENCHMARK_CAPTURE(simulated_frames, xyz_640x480_distorted, PathKind::xyz, "tum_fr1", true)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(simulated_frames, xyz_640x480_distorted_without_sensor, PathKind::xyz, "tum_fr1", false)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(simulated_frames, xyz_640x480, PathKind::xyz, "tum_fr3", true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(simulated_frames, halfsphere_640x480_distorted, PathKind::halfsphere, "tum_fr1", true)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(simulated_frames, rpy_640x480_distorted, PathKind::rpy, "tum_fr1", true)
    ->Unit(benchmark::kMillisecond);

void build_room(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(make_room(RoomKind::office, 1).world.objects.size());
}
BENCHMARK(build_room)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
