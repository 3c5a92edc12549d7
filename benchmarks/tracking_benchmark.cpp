// SPDX-License-Identifier: BSD-3-Clause
// Tracking time per frame as a ratio to cv::ORB(1000) on the same images, in the same process and on one thread: a
// ratio says the same on fast, slow and busy machines. Tracking is all from the images to the pose; decoding images and
// local mapping are left out. Reads $HOLDFAST_DATA/tum_fr1_xyz, or the simulated room when HOLDFAST_DATA is not set.
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <opencv2/core/utility.hpp>
#include <string>
#include <vector>

#include "holdfast/config/configuration.hpp"
#include "holdfast/evaluation/statistics.hpp"
#include "holdfast/pipeline/configured_pipeline.hpp"
#include "holdfast/plugin/builtin.hpp"
#include "orb_yardstick.hpp"

namespace holdfast {
namespace {

BuiltPipeline build(const std::string& extractor) {
  const char* data = std::getenv("HOLDFAST_DATA");
  const std::string source = data != nullptr ? "{ tum: { path: '" + std::string(data) + "/tum_fr1_xyz' } }"
                                             : std::string("{ simulated: { path: xyz, duration: 10 } }");
  const std::string text = "source: " + source + "\ncamera: tum_fr1\nfeatures: " + extractor + "\noptimizer: ceres\n";
  Registry registry;
  register_builtin_plugins(registry);
  const Configuration configuration =
      resolve_configuration(parse_yaml(text, "benchmark", "."), "benchmark", registry, pipeline_sections());
  return build_pipeline(configuration, registry);
}

void tracking(benchmark::State& state, const std::string& extractor) {
  cv::setNumThreads(1);
  std::vector<double> tracking_times, orb_times;
  OrbYardstick orb;
  for (auto _ : state) {
    BuiltPipeline built = build(extractor);
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

BENCHMARK_CAPTURE(tracking, orb, std::string("orb"))->Iterations(1)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(tracking, opencv_orb, std::string("opencv_orb"))
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace holdfast

BENCHMARK_MAIN();
