// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "holdfast/core/stage_times.hpp"
#include "holdfast/run/configured_pipeline.hpp"
#include "holdfast/run/run_record.hpp"

/// Runs a configuration from the first to the last frame of its source, at the configured pace, and collects a record
/// of the run, which results.hpp writes to files. `holdfast run` uses this function.
namespace holdfast {

/// Progress of a run after a frame.
struct RunProgress {
  std::uint64_t frames_done = 0;
  std::optional<std::uint64_t> frame_count;  ///< of the source; empty when it is unknown
  const FrameResult& result;                 ///< of this frame; valid during the call only
};

/// Options of a run besides its configuration. All callbacks are called in the thread that called run(), and an empty
/// callback is not called. on_start may throw: run() passes the exception on. An exception of on_frame ends the run and
/// is recorded as its failure. stop must not throw.
struct RunOptions {
  PipelineOptions pipeline;
  /// Called once with the constructed source; the run reads the returned source, for instance one that records the
  /// frames of the first. Not called for a pipeline that the caller has built.
  std::function<std::unique_ptr<FrameSource>(std::unique_ptr<FrameSource>)> wrap_source;
  /// Called once, after all modules have been made and before the first frame is read.
  std::function<void(const RunRecord& record)> on_start;
  std::function<void(const RunProgress& progress)> on_frame;
  /// Returns true to end the run early. Called before each frame, and ten times a second while waiting for one, but not
  /// while an observer waits for somebody in between.
  std::function<bool()> stop;
  /// Ends the run early, too; its source can be asked by any thread, also while an observer waits.
  std::stop_token stop_token = {};
  /// Start of the time measurement of RunRecord::start_seconds and total_seconds. A program can pass a stopwatch that
  /// includes the loading of the configuration.
  Stopwatch since_start;
};

/// Builds the pipeline of a configuration, feeds it with all frames of the source, and evaluates the trajectory where
/// the source has a true one. Throws as build_pipeline() does. An exception during the frames ends the run; what was
/// computed until then is in the record, with the message in RunRecord::failure. The library sets neither signal
/// handlers nor the number of OpenCV's threads: a program that wants the same times as `holdfast run` calls
/// cv::setNumThreads(1).
RunRecord run(const Configuration& configuration, const Registry& registry, const RunOptions& options = {});
/// Runs with the built-in modules and those of the configuration's plugins. Requires the library holdfast::holdfast.
inline RunRecord run(const Configuration& configuration, const RunOptions& options = {}) {
  Registry registry;
  register_builtin_plugins(registry);
  load_plugins(configuration, registry);
  return run(configuration, registry, options);
}

/// Runs a pipeline owned by the caller. Map and dense map remain in the pipeline and are empty in the record.
RunRecord run(BuiltPipeline& built, const Configuration& configuration, const RunOptions& options = {});

}  // namespace holdfast
