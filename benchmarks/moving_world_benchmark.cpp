// SPDX-License-Identifier: BSD-3-Clause
// What the moving world costs a frame: carrying the mask along and the filters, as ratios to cv::ORB(1000) on the same
// images, in the same process and on one thread. The network is left out. Reads the recording with exact masks in mask/
// that HOLDFAST_COMPOSED names, or the simulated room with people when it is not set.
#include <benchmark/benchmark.h>

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

namespace holdfast {
namespace {

BuiltPipeline build(const std::string& file) {
  std::vector<std::string> changes;
  if (const char* composed = std::getenv("HOLDFAST_COMPOSED")) {
    const std::string folder = composed;
    changes = {"source={ tum: { path: '" + folder + "' } }",
               "segmenter={ precomputed: { path: '" + folder + "/mask', labels: { 1-254: person } } }"};
  } else {
    changes = {"source={ simulated: { scene: '" HOLDFAST_SOURCE_DIR "/examples/scenes/walking_halfsphere.yaml' } }",
               "segmenter={ truth: {} }"};
  }
  Registry registry;
  register_builtin_plugins(registry);
  const Configuration configuration =
      load_configuration(HOLDFAST_SOURCE_DIR "/examples/configs/" + file, changes, registry);
  return build_pipeline(configuration, registry);
}

double seconds_in(const StageTimes& times, std::string_view stage) {
  double seconds = 0.0;
  for (const StageTimes::Entry& entry : times.entries())
    if (entry.stage == stage) seconds += entry.seconds;
  return seconds;
}

void moving_world(benchmark::State& state, const std::string& file) {
  constexpr std::size_t most_frames = 400;
  cv::setNumThreads(1);
  std::vector<double> carrying, filters, extra, orb_times;
  OrbYardstick orb;
  for (auto _ : state) {
    BuiltPipeline built = build(file);
    double total = 0.0;
    while (extra.size() < most_frames) {
      const auto frame = built.source->next();
      if (!frame) break;
      orb_times.push_back(orb.seconds(frame->colour));
      const FrameResult result = built.pipeline.feed(*frame);
      carrying.push_back(seconds_in(result.times, "masks"));
      filters.push_back(seconds_in(result.times, "filters"));
      extra.push_back(carrying.back() + filters.back());
      total += extra.back();
    }
    state.SetIterationTime(total);
  }
  const double orb_median = median(orb_times);
  state.counters["carrying_ms"] = 1e3 * median(carrying);
  state.counters["filters_ms"] = 1e3 * median(filters);
  state.counters["cv_orb_ms"] = 1e3 * orb_median;
  state.counters["carrying_ratio"] = median(carrying) / orb_median;
  state.counters["ratio"] = median(extra) / orb_median;
}

BENCHMARK_CAPTURE(moving_world, full, std::string("full.yaml"))
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(moving_world, paper, std::string("paper.yaml"))
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace holdfast

BENCHMARK_MAIN();
