// SPDX-License-Identifier: BSD-3-Clause
// long_run CONFIG FOLDER [key.path=value ...]: how the cost per frame and the memory of a run grow. Runs the
// configuration and writes one row per tenth of its frames into FOLDER/long_run.csv.
#include <malloc.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <opencv2/core/utility.hpp>
#include <string>
#include <vector>

#include "holdfast/evaluation/evaluation.hpp"
#include "holdfast/evaluation/statistics.hpp"
#include "holdfast/plugin/builtin.hpp"
#include "holdfast/run/configured_pipeline.hpp"

namespace holdfast {
namespace {

/// What a tenth of the run cost.
struct Part {
  std::vector<double> tracking, background;  // [s] per frame, and per keyframe
  std::size_t frames = 0, lost = 0, keyframes_made = 0;
  std::size_t keyframes = 0, points = 0, loops = 0;  // at its end
  double memory = 0.0;                               // resident at its end [MB]
  double allocated = 0.0;                            // of that, in use by the program's own allocations [MB]
};

/// Resident memory, what the allocator only keeps for later given back first.
double resident_megabytes() {
  malloc_trim(0);
  std::ifstream stream("/proc/self/statm");
  double total = 0.0, resident = 0.0;
  stream >> total >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

double allocated_megabytes() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd) / 1e6;
}

double tracking_of(const FrameResult& result) { return result.tracking_seconds; }

double background_of(const FrameResult& result) {
  double seconds = 0.0;
  for (const StageTimes::Entry& entry : result.times.entries())
    if (entry.stage.starts_with("mapping") || entry.stage.starts_with("loops")) seconds += entry.seconds;
  return seconds;
}

std::vector<Part> run(BuiltPipeline& built) {
  constexpr std::size_t parts = 10;
  const std::uint64_t count = built.source->describe().frame_count.value_or(0);
  if (count < parts) throw Error("expected a source that knows its number of frames, at least 10");
  std::vector<Part> result(parts);
  std::size_t fed = 0;
  while (const auto frame = built.source->next()) {
    const std::size_t now = std::min(parts - 1, fed * parts / count);
    Part& part = result[now];
    const FrameResult outcome = built.pipeline.feed(*frame);
    ++part.frames;
    part.tracking.push_back(tracking_of(outcome));
    if (outcome.is_keyframe) part.background.push_back(background_of(outcome)), ++part.keyframes_made;
    part.lost += outcome.status == TrackingStatus::lost ? 1 : 0;
    ++fed;
    if (fed < count && fed * parts / count == now) continue;
    part.keyframes = built.pipeline.map().keyframes().size();
    part.points = built.pipeline.map().points().size();
    part.loops = built.pipeline.loop_record().loops.size();
    part.memory = resident_megabytes();
    part.allocated = allocated_megabytes();
    std::fprintf(stderr, "%zu of %zu frames, tracking %.2f ms, %zu keyframes, %.0f MB, %.1f MB allocated\n", fed,
                 static_cast<std::size_t>(count), median(part.tracking) * 1e3, part.keyframes, part.memory,
                 part.allocated);
  }
  built.pipeline.finish();
  return result;
}

void write_table(const std::filesystem::path& file, const std::vector<Part>& parts) {
  std::ofstream csv(file);
  csv << "tenth,frames,lost,tracking_median_ms,tracking_p95_ms,keyframes_made,keyframe_median_ms,keyframes,points,"
         "loops,memory_mb,allocated_mb\n";
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Part& p = parts[i];
    csv << i + 1 << ',' << p.frames << ',' << p.lost << ',' << median(p.tracking) * 1e3 << ','
        << percentile(p.tracking, 95.0) * 1e3 << ',' << p.keyframes_made << ',' << median(p.background) * 1e3 << ','
        << p.keyframes << ',' << p.points << ',' << p.loops << ',' << p.memory << ',' << p.allocated << '\n';
  }
}

void report(const BuiltPipeline& built, const std::vector<Part>& parts) {
  std::printf("tracking, last tenth to second: %.3f\n", median(parts[9].tracking) / median(parts[1].tracking));
  std::printf("memory, end to second tenth: %.0f MB to %.0f MB\n", parts[9].memory, parts[1].memory);
  const Trajectory truth = built.source->truth();
  if (!truth.empty())
    std::printf("ATE RMSE %.4f m\n", evaluate(truth, built.pipeline.trajectory(), {}).absolute_error.rmse);
}

}  // namespace
}  // namespace holdfast

int main(int argument_count, char** arguments) try {
  using namespace holdfast;
  if (argument_count < 3) throw Error("usage: long_run CONFIG FOLDER [key.path=value ...]");
  cv::setNumThreads(1);
  Registry registry;
  register_builtin_plugins(registry);
  const Configuration configuration =
      load_configuration(arguments[1], {arguments + 3, arguments + argument_count}, registry);
  BuiltPipeline built = build_pipeline(configuration, registry);
  const std::vector<Part> parts = run(built);
  std::filesystem::create_directories(arguments[2]);
  write_table(std::filesystem::path(arguments[2]) / "long_run.csv", parts);
  report(built, parts);
} catch (const std::exception& error) {
  std::cerr << "error: " << error.what() << '\n';
  return 1;
}
