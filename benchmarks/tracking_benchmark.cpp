// SPDX-License-Identifier: BSD-3-Clause
// Tracking time per frame as a ratio to cv::ORB(1000) on the same images, in the same process and on one thread: a
// ratio says the same on fast, slow and busy machines. Tracking is all from the images to the pose; decoding images and
// local mapping are left out. Reads $HOLDFAST_DATA/tum_fr1_xyz, and $HOLDFAST_DATA/kitti_stereo_51 for stereo pairs, or
// the simulated room when HOLDFAST_DATA is not set.
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <map>
#include <numeric>
#include <opencv2/core/utility.hpp>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/config/configuration.hpp"
#include "holdfast/evaluation/statistics.hpp"
#include "holdfast/interfaces/feature_extractor.hpp"
#include "holdfast/plugin/builtin.hpp"
#include "holdfast/run/configured_pipeline.hpp"
#include "holdfast/tracking/inertial_motion.hpp"
#include "holdfast/tracking/pair_depth.hpp"
#include "orb_yardstick.hpp"
#include "processor_time.hpp"

namespace holdfast {
namespace {

BuiltPipeline build(const std::string& text) {
  Registry registry;
  register_builtin_plugins(registry);
  const Configuration configuration =
      resolve_configuration(parse_yaml(text, "benchmark", "."), "benchmark", registry, pipeline_sections());
  return build_pipeline(configuration, registry);
}

BuiltPipeline build_rgbd(const std::string& extractor) {
  const char* data = std::getenv("HOLDFAST_DATA");
  const std::string source = data != nullptr ? "{ tum: { path: '" + std::string(data) + "/tum_fr1_xyz' } }"
                                             : std::string("{ simulated: { path: xyz, duration: 10 } }");
  return build("source: " + source + "\ncamera: tum_fr1\nfeatures: " + extractor + "\noptimizer: schur\n");
}

/// Threaded, so that the calling thread tracks and does nothing else; the right image has a thread as well.
BuiltPipeline build_stereo(const std::string& extractor) {
  const char* data = std::getenv("HOLDFAST_DATA");
  const std::string source = data != nullptr
                                 ? "{ kitti: { path: '" + std::string(data) + "/kitti_stereo_51' } }"
                                 : std::string("{ simulated: { path: xyz, duration: 10, stereo_baseline: 0.11 } }");
  const std::string camera = data != nullptr ? "" : "camera: tum_fr3\n";
  return build("source: " + source + "\n" + camera + "features: " + extractor +
               "\noptimizer: schur\nrun: { mode: threaded }\n");
}

void tracking(benchmark::State& state, const std::string& extractor) {
  cv::setNumThreads(1);
  std::vector<double> tracking_times, orb_times;
  OrbYardstick orb;
  for (auto _ : state) {
    BuiltPipeline built = build_rgbd(extractor);
    double tracking_total = 0.0;
    while (const auto frame = built.source->next()) {
      orb_times.push_back(orb.seconds(frame->colour));
      tracking_times.push_back(built.pipeline.feed(*frame).tracking_seconds);
      tracking_total += tracking_times.back();
    }
    state.SetIterationTime(tracking_total);
  }
  state.counters["tracking_ms"] = 1e3 * median(tracking_times);
  state.counters["cv_orb_ms"] = 1e3 * median(orb_times);
  state.counters["ratio"] = median(tracking_times) / median(orb_times);
}

/// Wall-clock time says little on a busy machine, since the calling thread waits for the features of the right image:
/// `ratio` is of the processor time of the calling thread, `both_images` of that and of the features of one more image.
void stereo_tracking(benchmark::State& state, const std::string& extractor) {
  cv::setNumThreads(1);
  std::vector<double> tracking_times, orb_times, extraction_times;
  OrbYardstick orb;
  Registry registry;
  register_builtin_plugins(registry);
  const auto one_more = registry.create<FeatureExtractor>(extractor, {}, CreationContext{});
  Features features;
  cv::Mat grey;
  for (auto _ : state) {
    BuiltPipeline built = build_stereo(extractor);
    while (const auto frame = built.source->next()) {
      cv::cvtColor(frame->colour, grey, cv::COLOR_BGR2GRAY);
      orb.add_thread_seconds(frame->colour, orb_times);
      time(extraction_times, [&] { one_more->extract(grey, cv::Mat(), features); });
      time(tracking_times, [&] { built.pipeline.feed(*frame); });
    }
    built.pipeline.finish();
    state.SetIterationTime(std::accumulate(tracking_times.begin(), tracking_times.end(), 0.0));
  }
  state.counters["tracking_ms"] = 1e3 * median(tracking_times);
  state.counters["cv_orb_ms"] = 1e3 * median(orb_times);
  state.counters["ratio"] = median(tracking_times) / median(orb_times);
  state.counters["both_images"] = (median(tracking_times) + median(extraction_times)) / median(orb_times);
}

/// Dense depth of a pair, as filters get it of every frame and the map of keyframes; processor time.
void dense_stereo(benchmark::State& state) {
  cv::setNumThreads(1);
  std::vector<double> dense_times, orb_times;
  OrbYardstick orb;
  cv::Mat grey;
  for (auto _ : state) {
    const BuiltPipeline built = build_stereo("orb");
    PairDepth depth(built.pipeline.camera(), {.is_dense = true});
    while (const auto frame = built.source->next()) {
      cv::cvtColor(frame->colour, grey, cv::COLOR_BGR2GRAY);
      orb.add_thread_seconds(frame->colour, orb_times);
      time(dense_times, [&] { benchmark::DoNotOptimize(depth.begin(*frame, grey)); });
    }
    state.SetIterationTime(std::accumulate(dense_times.begin(), dense_times.end(), 0.0));
  }
  state.counters["dense_ms"] = 1e3 * median(dense_times);
  state.counters["cv_orb_ms"] = 1e3 * median(orb_times);
  state.counters["ratio"] = median(dense_times) / median(orb_times);
}

/// The inertial part of tracking, with true poses of the simulated room: prediction, test and correction of every
/// frame, and the attempts to start. `ratio` is of the means of processor times, `median` of the medians.
void inertial_tracking(benchmark::State& state, bool scale_is_known) {
  cv::setNumThreads(1);
  std::vector<double> inertial_times, orb_times;
  OrbYardstick orb;
  for (auto _ : state) {
    const BuiltPipeline built = build(
        "source: { simulated: { path: xyz, duration: 20 } }\ncamera: tum_fr3\nimu: bmi055\nfeatures: orb\n"
        "optimizer: schur\n");
    InertialMotion inertia(built.source->describe().imu, scale_is_known);
    std::map<double, Eigen::Isometry3d> poses;  // T_camera_world
    const auto past_pose = [&poses](double timestamp) -> std::optional<Eigen::Isometry3d> {
      const auto found = poses.find(timestamp);
      return found != poses.end() ? std::optional(found->second) : std::nullopt;
    };
    std::optional<Eigen::Isometry3d> last;
    while (const auto frame = built.source->next()) {
      orb.add_thread_seconds(frame->colour, orb_times);
      const Eigen::Isometry3d pose = frame->truth->T_world_camera->inverse();
      poses[frame->timestamp] = pose;
      time(inertial_times, [&] {
        inertia.begin_frame(*frame);
        if (last) inertia.follow_map(*last);
        benchmark::DoNotOptimize(inertia.prediction());
        benchmark::DoNotOptimize(inertia.contradicts(pose, 1.0));
        inertia.found(pose, 0.001, past_pose);
      });
      last = pose;
    }
    if (!inertia.is_reliable()) state.SkipWithError("the inertial state is not reliable");
    state.SetIterationTime(std::accumulate(inertial_times.begin(), inertial_times.end(), 0.0));
  }
  const auto mean = [](const std::vector<double>& times) {
    return std::accumulate(times.begin(), times.end(), 0.0) / static_cast<double>(times.size());
  };
  state.counters["inertial_ms"] = 1e3 * mean(inertial_times);
  state.counters["cv_orb_ms"] = 1e3 * mean(orb_times);
  state.counters["ratio"] = mean(inertial_times) / mean(orb_times);
  state.counters["median"] = median(inertial_times) / median(orb_times);
}

BENCHMARK_CAPTURE(tracking, orb, std::string("orb"))->Iterations(1)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(tracking, opencv_orb, std::string("opencv_orb"))
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(stereo_tracking, orb, std::string("orb"))
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(inertial_tracking, depth, true)->Iterations(1)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(inertial_tracking, one_camera, false)->Iterations(1)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(dense_stereo)->Iterations(1)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace holdfast

BENCHMARK_MAIN();
