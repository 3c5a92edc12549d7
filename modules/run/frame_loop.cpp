// SPDX-License-Identifier: BSD-3-Clause
#include "frame_loop.hpp"

#include <exception>
#include <optional>

#include "holdfast/run/frame_feeder.hpp"

namespace holdfast {

namespace {

/// Feeds one frame at a time and collects its results.
class FrameLoop {
 public:
  FrameLoop(Pipeline& pipeline, const RunOptions& options, RunRecord& record)
      : pipeline_(pipeline), options_(options), record_(record) {}

  bool stopped() const { return options_.stop && options_.stop(); }
  void feed(const SensorFrame& frame, double decode_seconds) {
    const FrameResult result = pipeline_.feed(frame);
    record_.summary.add(result, decode_seconds);
    take_background_times();
    if (record_.start_seconds == 0.0 && result.T_world_camera) record_.start_seconds = options_.since_start.seconds();
    ++done_;
    if (options_.on_frame) options_.on_frame({done_, record_.source.frame_count, result});
  }
  void take_background_times() {
    for (const StageTimes& times : pipeline_.take_background_times()) record_.summary.add(times);
  }

 private:
  Pipeline& pipeline_;
  const RunOptions& options_;
  RunRecord& record_;
  std::uint64_t done_ = 0;
};

void feed_sequentially(FrameSource& source, FrameLoop& loop, RunRecord& record) {
  while (!loop.stopped()) {
    const Stopwatch decoding;
    const std::optional<SensorFrame> frame = source.next();
    if (!frame) break;
    const double decode_seconds = decoding.seconds();
    record.frame_stamps.push_back(frame->timestamp);
    loop.feed(*frame, decode_seconds);
  }
}

void feed_from_thread(FrameFeeder& feeder, FrameLoop& loop, ThreadRecord& threads) {
  while (!loop.stopped()) {
    const std::optional<FedFrame> fed = feeder.next();
    if (!fed) break;
    loop.feed(fed->frame, fed->decode_seconds);
    threads.delays.push_back(fed->since_due.seconds());
  }
}

}  // namespace

void feed_frames(BuiltPipeline& built, const RunOptions& options, RunRecord& record) {
  FrameLoop loop(built.pipeline, options, record);
  std::optional<FrameFeeder> feeder;
  if (record.configuration.run.threaded()) {
    record.threads.emplace();
    feeder.emplace(*built.source, record.configuration.run);
  }
  try {
    if (feeder)
      feed_from_thread(*feeder, loop, *record.threads);
    else
      feed_sequentially(*built.source, loop, record);
  } catch (const std::exception& error) {  // the results until here are kept
    record.failure = error.what();
  }
  if (feeder) feeder->stop();
  record.was_interrupted = loop.stopped();
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
