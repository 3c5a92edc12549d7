// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/cli/frame_loop.hpp"

#include <exception>
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

void feed_beside(FrameSource& source, const RunSettings& run, FrameLoop& loop, RunRecord& record) {
  FrameFeeder feeder(source, {.by_timestamps = run.pace == "timestamps",
                              .drop_late = run.late_frames == "drop",
                              .frame_queue = static_cast<std::size_t>(run.frame_queue)});
  ThreadRecord& threads = record.threads.emplace();
  const auto note = [&] {
    threads.frames = feeder.counts();
    threads.late = feeder.late();
    threads.latest = feeder.latest();
    record.frame_stamps = feeder.stamps();
  };
  try {
    while (!interrupted()) {
      const std::optional<FedFrame> fed = feeder.next();
      if (!fed) break;
      loop.feed(fed->frame, fed->decode_seconds);
      threads.delays.push_back(fed->since_due.seconds());
    }
  } catch (...) {
    feeder.stop();
    note();
    throw;
  }
  feeder.stop();
  note();
}

}  // namespace

void feed_frames(BuiltPipeline& built, bool quiet, const Stopwatch& since_start, RunRecord& record) {
  FrameLoop loop(built.pipeline, quiet, since_start, record);
  try {
    const RunSettings& run = record.configuration->run;
    if (run.mode == "threaded")
      feed_beside(*built.source, run, loop, record);
    else
      feed_in_turn(*built.source, loop, record);
  } catch (const std::exception& error) {  // whatever it is, what was found until then is the user's
    record.failure = error.what();
  }
  record.was_interrupted = interrupted();
  if (record.was_interrupted) built.pipeline.interrupt();
  try {
    built.pipeline.finish();
  } catch (const std::exception& error) {
    if (record.failure.empty()) record.failure = error.what();
  }
  loop.take_background_times();
  if (!record.threads) return;
  record.threads->workers = built.pipeline.worker_counts();
  record.threads->keyframes_deferred = built.pipeline.keyframes_deferred();
}

}  // namespace holdfast
