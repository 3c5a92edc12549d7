// SPDX-License-Identifier: BSD-3-Clause
// Processor time of whole sequential runs per frame, and the time of local bundle adjustment per keyframe, as ratios to
// cv::ORB(1000) on the same images, in the same process and on one thread. Reads the recording $HOLDFAST_COMPOSED with
// people if it is set, otherwise $HOLDFAST_DATA/tum_fr1_xyz, or the simulated room when neither is.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cstdlib>
#include <opencv2/core/utility.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "holdfast/config/configuration.hpp"
#include "holdfast/evaluation/statistics.hpp"
#include "holdfast/plugin/builtin.hpp"
#include "holdfast/run/configured_pipeline.hpp"
#include "orb_yardstick.hpp"
#include "processor_time.hpp"

namespace holdfast {
namespace {

/// Adds up the processor time of calls.
class ProcessorTime {
 public:
  template <class Function>
  auto measure(Function&& function) {
    const double begin = processor_seconds();
    auto result = function();
    total_ += processor_seconds() - begin;
    return result;
  }
  double total() const { return total_; }

 private:
  double total_ = 0.0;
};

/// The YAML of the recording to run on, see the head of this file.
std::string source_of_images() {
  const auto recording = [](const std::string& path) { return "{ tum: { path: '" + path + "' } }"; };
  if (const char* composed = std::getenv("HOLDFAST_COMPOSED")) return recording(composed);
  if (const char* data = std::getenv("HOLDFAST_DATA")) return recording(data + std::string("/tum_fr1_xyz"));
  return "{ simulated: { path: xyz, duration: 10 } }";
}

BuiltPipeline build(const std::string& file, const std::string& optimizer) {
  Registry registry;
  register_builtin_plugins(registry);
  const Configuration configuration =
      load_configuration(HOLDFAST_SOURCE_DIR "/examples/configs/" + file,
                         {"source=" + source_of_images(), "optimizer=" + optimizer, "run.mode=sequential"}, registry);
  return build_pipeline(configuration, registry);
}

void whole_run(benchmark::State& state, const std::string& file, const std::string& optimizer) {
  constexpr std::string_view stage = "mapping: bundle adjustment";
  cv::setNumThreads(1);
  ProcessorTime decoding, feeding, extracting;
  std::vector<double> bundle_times, orb_times, beyond_stages;
  OrbYardstick orb;
  double frames = 0.0;
  for (auto _ : state) {
    BuiltPipeline built = build(file, optimizer);
    while (const auto frame = decoding.measure([&] { return built.source->next(); })) {
      orb_times.push_back(extracting.measure([&] { return orb.seconds(frame->colour); }));
      const auto begin = std::chrono::steady_clock::now();
      const FrameResult result = feeding.measure([&] { return built.pipeline.feed(*frame); });
      double beyond = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      for (const StageTimes::Entry& entry : result.times.entries()) {
        if (entry.stage == stage) bundle_times.push_back(entry.seconds);
        beyond -= entry.seconds;
      }
      beyond_stages.push_back(beyond);
      ++frames;
    }
    feeding.measure([&] { return built.pipeline.finish(), 0; });
    state.SetIterationTime(decoding.total() + feeding.total());
  }
  state.counters["cv_orb_ms"] = 1e3 * extracting.total() / frames;
  state.counters["decoding"] = decoding.total() / extracting.total();
  state.counters["without_decoding"] = feeding.total() / extracting.total();
  state.counters["ratio"] = (decoding.total() + feeding.total()) / extracting.total();
  // What feed() does between its stages; tools/feed_from_python.py measures the same with Python around it.
  state.counters["beyond_stages_us"] = 1e6 * median(beyond_stages);
  state.counters["bundle_ratio"] = median(bundle_times) / median(orb_times);
}

void add(const std::string& configuration, const std::string& optimizer) {
  benchmark::RegisterBenchmark((configuration + "/" + optimizer).c_str(),
                               [=](benchmark::State& state) { whole_run(state, configuration + ".yaml", optimizer); })
      ->Iterations(1)
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond);
}

}  // namespace
}  // namespace holdfast

int main(int count, char** arguments) {
  for (const char* optimizer : {"schur", "ceres"})
    for (const char* configuration : {"rgbd", "geometric", "full", "paper"}) holdfast::add(configuration, optimizer);
  benchmark::Initialize(&count, arguments);
  if (benchmark::ReportUnrecognizedArguments(count, arguments)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
