// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "holdfast/plugin/choice.hpp"

namespace holdfast {

template <class Settings>
class ParameterTable;

/// sequential: one thread does all the work of a frame and gives the same bits on every run. threaded: tracking, local
/// mapping, loop closing, full adjustment and segmentation have one thread each.
enum class RunMode { sequential, threaded };
/// When frames reach tracking. none: as fast as they can be read and tracked. timestamps: at their time stamps.
enum class Pace { none, timestamps };
/// Handling of a frame in a paced run if the frame queue is full. queue: the source waits for room. drop: the oldest
/// frame of the queue is discarded.
enum class LateFrames { queue, drop };

template <>
inline constexpr Choice<RunMode> choice_table<RunMode>[] = {{"sequential", RunMode::sequential},
                                                            {"threaded", RunMode::threaded}};
template <>
inline constexpr Choice<Pace> choice_table<Pace>[] = {{"none", Pace::none}, {"timestamps", Pace::timestamps}};
template <>
inline constexpr Choice<LateFrames> choice_table<LateFrames>[] = {{"queue", LateFrames::queue},
                                                                  {"drop", LateFrames::drop}};

/// The `run` section of a configuration: threads, pace and seed. Configuration, PipelineBuilder, Pipeline and
/// FrameFeeder share this struct; each reads the fields that concern it.
struct RunSettings {
  RunMode mode = RunMode::sequential;
  std::uint64_t seed = 1;  ///< seed of every random number generator of the run
  /// Needs threaded mode. A paced pipeline never waits for local mapping: a keyframe that finds the keyframe queue full
  /// is deferred. Otherwise tracking waits for room in that queue.
  Pace pace = Pace::none;
  LateFrames late_frames = LateFrames::queue;  ///< only read in a paced run
  int prefetch = 2;        ///< sequential mode: frames that another thread reads ahead; 0 = read by the same thread
  int frame_queue = 4;     ///< max. frames waiting for tracking; four frames bridge a pause of 130 ms at 30 Hz
  int keyframe_queue = 4;  ///< max. keyframes waiting for local mapping, and max. waiting for loop closing
  double minimum_coverage = 0.5;  ///< share of frames with a pose below which a run counts as a failure; 0 = never

  /// The reason why the fields do not fit together; empty when they do.
  std::optional<std::string> contradiction() const;
  bool threaded() const { return mode == RunMode::threaded; }
  bool paced() const { return pace == Pace::timestamps; }

  static void describe(ParameterTable<RunSettings>& table);
};

}  // namespace holdfast
