// SPDX-License-Identifier: BSD-3-Clause
#include "frame_loop.hpp"

#include <exception>
#include <optional>
#include <stop_token>
#include <utility>

#include "holdfast/run/frame_feeder.hpp"
#include "repeated_images.hpp"

namespace holdfast {

namespace {

/// Feeds one frame at a time and collects its results.
class FrameLoop {
 public:
  FrameLoop(Pipeline& pipeline, const RunOptions& options, RunRecord& record)
      : pipeline_(pipeline), options_(options), record_(record) {}

  bool stopped() const { return options_.stop_token.stop_requested() || (options_.stop && options_.stop()); }
  /// Feeds the frame that `read` gives. False at the end of the source.
  template <class Read>
  bool feed_next(const Read& read) {
    source_has_more_ = false;
    const std::optional<FedFrame> fed = read();
    if (!fed) {
      source_has_more_ = stopped();
      return false;
    }
    source_has_more_ = true;
    if (!record_.threads) record_.frame_stamps.push_back(fed->frame.timestamp);  // else the reader keeps them
    last_index_ = fed->frame.index;
    repeats_.add(fed->frame.timestamp, fed->fingerprint);
    record_.repeated_images = repeats_.found();
    feed(fed->frame, fed->decode_seconds);
    if (record_.threads) record_.threads->delays.push_back(fed->since_due.seconds());
    return true;
  }
  void take_background_times() {
    for (const StageTimes& times : pipeline_.take_background_times()) record_.summary.add(times);
  }
  /// Whether the source would have skipped this frame if frames were read one by one: reading ahead skips frames that
  /// come after the last frame of a run that was ended before its source.
  bool has_reached(const SkippedFrame& skipped) const {
    return !source_has_more_ || (last_index_ && skipped.index < *last_index_);
  }

 private:
  void feed(const SensorFrame& frame, double decode_seconds) {
    const FrameResult result = pipeline_.feed(frame);
    record_.summary.add(result, decode_seconds);
    take_background_times();
    if (record_.start_seconds == 0.0 && result.T_world_camera) record_.start_seconds = options_.since_start.seconds();
    ++done_;
    if (options_.on_frame) options_.on_frame({done_, record_.source.frame_count, result});
  }

  Pipeline& pipeline_;
  const RunOptions& options_;
  RunRecord& record_;
  std::uint64_t done_ = 0;
  bool source_has_more_ = true;
  std::optional<std::uint64_t> last_index_;
  RepeatFinder repeats_;
};

std::optional<FedFrame> read_now(FrameSource& source) {
  const Stopwatch decoding;
  std::optional<SensorFrame> frame = source.next();
  if (!frame) return std::nullopt;
  const double decode_seconds = decoding.seconds();
  const std::uint64_t fingerprint = image_fingerprint(frame->colour);
  return FedFrame{std::move(*frame), decode_seconds, fingerprint, Stopwatch()};
}

/// Starts the thread that reads the source: always in threaded mode, otherwise where reading ahead cannot change the
/// frames.
void start_reader(FrameSource& source, const RunRecord& record, std::optional<FrameFeeder>& feeder) {
  RunSettings settings = record.configuration.run;
  if (!settings.threaded()) {
    if (settings.prefetch == 0 || !record.source.can_read_ahead) return;
    settings.frame_queue = settings.prefetch;
  }
  feeder.emplace(source, settings);
}

/// Feeds frames and finishes the pipeline. No thread reads the source afterwards.
void feed_all(BuiltPipeline& built, const RunOptions& options, FrameLoop& loop, RunRecord& record) {
  std::optional<FrameFeeder> feeder;
  start_reader(*built.source, record, feeder);
  const std::stop_callback interrupting(options.stop_token, [&built] {
    built.source->interrupt();
    built.pipeline.interrupt();
  });
  try {
    while (!loop.stopped() && loop.feed_next([&] {
      return feeder ? feeder->next([&loop] { return loop.stopped(); }) : read_now(*built.source);
    })) {
    }
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
  if (!record.threads) return;
  record.frame_stamps = feeder->stamps();
  record.threads->frames = feeder->counts();
  record.threads->late = feeder->late();
  record.threads->largest_delay = feeder->largest_delay();
  record.threads->workers = built.pipeline.worker_counts();
  record.threads->keyframes_deferred = built.pipeline.keyframes_deferred();
}

}  // namespace

void feed_frames(BuiltPipeline& built, const RunOptions& options, RunRecord& record) {
  if (record.configuration.run.threaded()) record.threads.emplace();
  FrameLoop loop(built.pipeline, options, record);
  feed_all(built, options, loop, record);
  for (SkippedFrame& skipped : built.source->skipped())
    if (record.threads || loop.has_reached(skipped)) record.skipped.push_back(std::move(skipped));
}

}  // namespace holdfast
