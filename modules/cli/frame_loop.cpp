// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/cli/frame_loop.hpp"

#include <exception>
#include <optional>
#include <utility>

#include "holdfast/cli/terminal.hpp"
#include "holdfast/pipeline/frame_feeder.hpp"

namespace holdfast {

namespace {

/// Everything that happens to one frame.
class FrameLoop {
 public:
  FrameLoop(Pipeline& pipeline, bool quiet, const Stopwatch& since_start, RunRecord& record)
      : pipeline_(pipeline), since_start_(since_start), record_(record), progress_(record.source.frame_count, quiet) {}

  void feed(const SensorFrame& frame, double decode_seconds) {
    const FrameResult result = pipeline_.feed(frame);
    record_.summary.add(result, decode_seconds);
    take_background_times();
    if (record_.start_seconds == 0.0 && result.T_world_camera) record_.start_seconds = since_start_.seconds();
    progress_.update(++fed_, to_string(result.status));
  }
  void take_background_times() {
    for (const StageTimes& times : pipeline_.take_background_times()) record_.summary.add(times);
  }

 private:
  Pipeline& pipeline_;
  const Stopwatch& since_start_;
  RunRecord& record_;
  Progress progress_;
  std::uint64_t fed_ = 0;
};

void feed_in_turn(FrameSource& source, FrameLoop& loop, RunRecord& record) {
  while (!interrupted()) {
    const Stopwatch decoding;
    const std::optional<SensorFrame> frame = source.next();
    if (!frame) break;
    const double decode_seconds = decoding.seconds();
    record.frame_stamps.push_back(frame->timestamp);
    loop.feed(*frame, decode_seconds);
  }
}

void feed_beside(FrameFeeder& feeder, FrameLoop& loop, ThreadRecord& threads) {
  while (!interrupted()) {
    const std::optional<FedFrame> fed = feeder.next();
    if (!fed) break;
    loop.feed(fed->frame, fed->decode_seconds);
    threads.delays.push_back(fed->since_due.seconds());
  }
}

}  // namespace

void feed_frames(BuiltPipeline& built, bool quiet, const Stopwatch& since_start, RunRecord& record) {
  FrameLoop loop(built.pipeline, quiet, since_start, record);
  const RunSettings& run = record.configuration->run;
  std::optional<FrameFeeder> feeder;
  if (run.mode == "threaded") {
    record.threads.emplace();
    feeder.emplace(*built.source, PaceSettings{.by_timestamps = run.pace == "timestamps",
                                               .drop_late = run.late_frames == "drop",
                                               .frame_queue = static_cast<std::size_t>(run.frame_queue)});
  }
  try {
    if (feeder)
      feed_beside(*feeder, loop, *record.threads);
    else
      feed_in_turn(*built.source, loop, record);
  } catch (const std::exception& error) {  // whatever it is, what was found until then is the user's
    record.failure = error.what();
  }
  if (feeder) feeder->stop();
  record.was_interrupted = interrupted();
  if (record.was_interrupted) built.pipeline.interrupt();
  try {
    built.pipeline.finish();
  } catch (const std::exception& error) {
    if (record.failure.empty()) record.failure = error.what();
  }
  loop.take_background_times();
  if (!feeder) return;
  record.frame_stamps = feeder->stamps();
  record.threads->frames = feeder->counts();
  record.threads->late = feeder->late();
  record.threads->latest = feeder->latest();
  record.threads->workers = built.pipeline.worker_counts();
  record.threads->keyframes_deferred = built.pipeline.keyframes_deferred();
}

}  // namespace holdfast
