// SPDX-License-Identifier: BSD-3-Clause
// Time of motion-only adjustment, of local bundle adjustment and of the adjustment of whole maps, on synthetic
// problems.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "geometry/synthetic.hpp"
#include "holdfast/core/median.hpp"
#include "holdfast/geometry/pose_problem.hpp"
#include "holdfast/geometry/preintegration.hpp"
#include "optimizers/both_optimizers.hpp"
#include "processor_time.hpp"

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
void optimize_bundle(benchmark::State& state, const std::string& name) {
  const Camera camera = synthetic::camera();
  const synthetic::BundleCase original =
      synthetic::bundle_case(camera, static_cast<int>(state.range(0)), static_cast<int>(state.range(1)),
                             static_cast<int>(state.range(2)), static_cast<int>(state.range(3)), 1.0, 0.03, 1);
  const auto optimizer = make_optimizer(name);
  const std::atomic<bool> stop = false;
  BundleSummary summary;
  for (auto _ : state) {
    BundleProblem problem = original.problem;
    summary = optimizer->optimize_bundle(problem, stop);
  }
  state.counters["observations"] = static_cast<double>(original.problem.observations.size());
  state.counters["iterations"] = summary.iterations;
}
void bundle_sizes(benchmark::internal::Benchmark* each) {
  each->Args({5, 5, 1000, 8})->Args({12, 13, 1500, 10})->Args({12, 13, 3000, 10})->Args({1, 60, 6000, 10});
  each->Unit(benchmark::kMillisecond);
}
BENCHMARK_CAPTURE(optimize_bundle, ceres, std::string("ceres"))->Apply(bundle_sizes);
BENCHMARK_CAPTURE(optimize_bundle, schur, std::string("schur"))->Apply(bundle_sizes);

/// Links successive poses, 0.2 s apart, by preintegrated measurements that fit their rotations.
void add_inertial_factors(const std::vector<Eigen::Isometry3d>& poses, BundleProblem& problem) {
  constexpr double interval = 0.01;
  constexpr int steps = 20;
  BundleFactors& factors = problem.factors;
  for (std::uint32_t i = 0; i < poses.size(); ++i) factors.motions.push_back({.pose = i, .bias = {}});
  for (std::uint32_t i = 1; i < poses.size(); ++i) {
    const Eigen::Matrix3d turn = poses[i - 1].linear() * poses[i].linear().transpose();
    const Eigen::Vector3d rate = geometry::log_so3(turn) / (interval * steps);
    geometry::Preintegration measured(ImuNoise{});
    for (int k = 0; k < steps; ++k) measured.integrate(rate, -(poses[i - 1].linear() * factors.gravity), interval);
    factors.inertial.push_back({i - 1, i, measured});
  }
}

/// Time per iteration of an adjustment of a whole map of `poses` keyframes, with inertial factors and without them.
void optimize_map(benchmark::State& state, bool with_inertia) {
  const Camera camera = synthetic::camera();
  const auto poses = static_cast<int>(state.range(0));
  synthetic::BundleCase original = synthetic::bundle_case(camera, 1, poses - 1, 40 * poses, 60, 1.0, 0.03, 1);
  original.problem.robust_iterations = original.problem.final_iterations = 5;
  original.problem.function_tolerance = 1e-15;
  if (with_inertia) add_inertial_factors(original.poses, original.problem);
  const auto optimizer = make_optimizer("schur");
  const std::atomic<bool> stop = false;
  BundleSummary summary;
  for (auto _ : state) {
    BundleProblem problem = original.problem;
    summary = optimizer->optimize_bundle(problem, stop);
  }
  state.counters["iterations"] = summary.iterations;
  state.counters["per_iteration"] = benchmark::Counter(
      summary.iterations, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK_CAPTURE(optimize_map, visual, false)->Arg(40)->Arg(160)->Arg(640)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(optimize_map, inertial, true)->Arg(40)->Arg(160)->Arg(640)->Unit(benchmark::kMillisecond);

/// Processor time per iteration of an adjustment of a local map with inertial factors relative to the same one without
/// them, in turn. Arguments: fixed poses, free poses, points, observations at most per point.
void inertial_local_map(benchmark::State& state) {
  const Camera camera = synthetic::camera();
  const synthetic::BundleCase visual =
      synthetic::bundle_case(camera, static_cast<int>(state.range(0)), static_cast<int>(state.range(1)),
                             static_cast<int>(state.range(2)), static_cast<int>(state.range(3)), 1.0, 0.03, 1);
  synthetic::BundleCase inertial = visual;
  add_inertial_factors(inertial.poses, inertial.problem);
  const auto optimizer = make_optimizer("schur");
  const std::atomic<bool> stop = false;
  const auto seconds_per_iteration = [&](const BundleProblem& original) {
    BundleProblem problem = original;
    problem.robust_iterations = problem.final_iterations = 5;
    problem.function_tolerance = 1e-15;
    BundleSummary summary;
    std::vector<double> times;
    time(times, [&] { summary = optimizer->optimize_bundle(problem, stop); });
    return times.front() / summary.iterations;
  };
  std::vector<double> ratios;
  for (auto _ : state) {
    const double without = seconds_per_iteration(visual.problem);
    ratios.push_back(seconds_per_iteration(inertial.problem) / without);
  }
  state.counters["to_visual"] = upper_median(ratios);
}
BENCHMARK(inertial_local_map)->Args({12, 13, 1500, 10})->Args({12, 20, 3000, 12})->Unit(benchmark::kMillisecond);

/// How long an adjustment goes on after it was asked to stop, at moments spread over its whole time; the counters are
/// in milliseconds. Arguments as above.
void stop_bundle(benchmark::State& state, const std::string& name) {
  const Camera camera = synthetic::camera();
  const synthetic::BundleCase original =
      synthetic::bundle_case(camera, static_cast<int>(state.range(0)), static_cast<int>(state.range(1)),
                             static_cast<int>(state.range(2)), static_cast<int>(state.range(3)), 1.0, 0.03, 1);
  const auto optimizer = make_optimizer(name);
  using Clock = std::chrono::steady_clock;
  const auto seconds_since = [](Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
  };
  std::vector<double> delays;
  for (auto _ : state) {
    BundleProblem problem = original.problem;
    std::atomic<bool> stop = false;
    const Clock::time_point begin = Clock::now();
    optimizer->optimize_bundle(problem, stop);
    const double whole = seconds_since(begin);
    for (int i = 0; i < 10; ++i) {
      problem = original.problem;
      stop = false;
      Clock::time_point asked;
      std::jthread asking([&] {
        std::this_thread::sleep_for(std::chrono::duration<double>(whole * (i + 0.5) / 10));
        asked = Clock::now();
        stop = true;
      });
      optimizer->optimize_bundle(problem, stop);
      const Clock::time_point end = Clock::now();
      asking.join();
      if (end > asked) delays.push_back(std::chrono::duration<double>(end - asked).count());
    }
  }
  std::sort(delays.begin(), delays.end());
  if (delays.empty()) return;
  state.counters["stop_median_ms"] = delays[delays.size() / 2] * 1e3;
  state.counters["stop_longest_ms"] = delays.back() * 1e3;
}
void stop_sizes(benchmark::internal::Benchmark* each) {
  each->Args({12, 20, 3000, 12})->Args({1, 60, 6000, 10})->Iterations(3)->Unit(benchmark::kMillisecond);
}
BENCHMARK_CAPTURE(stop_bundle, ceres, std::string("ceres"))->Apply(stop_sizes);
BENCHMARK_CAPTURE(stop_bundle, schur, std::string("schur"))->Apply(stop_sizes);

}  // namespace
}  // namespace holdfast

BENCHMARK_MAIN();
