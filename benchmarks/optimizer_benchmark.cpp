// SPDX-License-Identifier: BSD-3-Clause
// Time of motion-only adjustment and of local bundle adjustment, on synthetic problems of the size that tracking and
// local mapping pose.
#include <benchmark/benchmark.h>

#include "holdfast/geometry/pose_adjustment.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "geometry/synthetic.hpp"

extern "C" void holdfast_register_plugin_ceres(holdfast::Registry& registry);

namespace holdfast {
namespace {

void adjust_pose(benchmark::State& state) {
  const Camera camera = synthetic::camera();
  const synthetic::PoseCase original = synthetic::pose_case(camera, static_cast<int>(state.range(0)), 1.0, 0.1, 1);
  PoseProblem problem = original.problem;
  PoseSummary summary;
  for (auto _ : state) {
    problem.T_camera_world = original.problem.T_camera_world;
    summary = geometry::adjust_pose(problem);
    benchmark::DoNotOptimize(summary);
  }
  state.counters["iterations"] = summary.iterations;
}
BENCHMARK(adjust_pose)->Arg(300)->Arg(1000)->Unit(benchmark::kMicrosecond);

/// Arguments: fixed poses, free poses, points, observations at most per point.
void optimize_bundle(benchmark::State& state) {
  const Camera camera = synthetic::camera();
  const synthetic::BundleCase original =
      synthetic::bundle_case(camera, static_cast<int>(state.range(0)), static_cast<int>(state.range(1)),
                             static_cast<int>(state.range(2)), static_cast<int>(state.range(3)), 1.0, 0.03, 1);
  Registry registry;
  holdfast_register_plugin_ceres(registry);
  const auto optimizer = registry.create<Optimizer>("ceres", {}, {});
  const std::atomic<bool> stop = false;
  BundleSummary summary;
  for (auto _ : state) {
    BundleProblem problem = original.problem;
    summary = optimizer->optimize_bundle(problem, stop);
  }
  state.counters["observations"] = static_cast<double>(original.problem.observations.size());
  state.counters["iterations"] = summary.iterations;
}
BENCHMARK(optimize_bundle)
    ->Args({5, 5, 1000, 8})
    ->Args({12, 13, 1500, 10})
    ->Args({12, 13, 3000, 10})
    ->Args({1, 60, 6000, 10})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace holdfast

BENCHMARK_MAIN();
