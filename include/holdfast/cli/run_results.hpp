// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/config/configuration.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/evaluation/evaluation.hpp"
#include "holdfast/evaluation/run_summary.hpp"
#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/pipeline/pipeline.hpp"

namespace holdfast {

/// What the threads of a run did.
struct ThreadRecord {
  QueueCounts frames;          ///< between the source and tracking
  std::uint64_t late = 0;      ///< paced: frames that the source gave after they were due
  double latest = 0.0;         ///< by how much at most [s]
  std::vector<double> delays;  ///< from when a frame was due (unpaced: read) until it had its result [s]
  /// Share of the delays above 33 ms: a frame of a camera at 30 Hz.
  double late_share() const;
  std::vector<WorkerCounts> workers;
  std::uint64_t keyframes_deferred = 0;  ///< due, but local mapping had no room for them
};

/// All that is known at the end of a run.
struct RunRecord {
  const Configuration* configuration = nullptr;
  SourceDescription source;
  Camera camera;
  RunSummary summary;
  std::vector<SkippedFrame> skipped;
  std::vector<double> frame_stamps;  ///< of all frames that came, skipped ones included [s]
  std::size_t frames_expected = 0;   ///< as the source said, or those that came
  Trajectory trajectory, keyframes;
  std::size_t map_keyframes = 0, map_points = 0;
  MappingCounts mapping;
  LoopRecord loops;
  std::vector<double> mask_ages;  ///< of the masks of segmented frames when they came: frames went on meanwhile [s]
  std::optional<ThreadRecord> threads;  ///< in threaded mode
  std::optional<Evaluation> evaluation;
  std::string no_evaluation;   ///< why there is none
  double start_seconds = 0.0;  ///< from the start of the program to the first pose
  double total_seconds = 0.0;
  std::size_t peak_memory = 0;  ///< resident [bytes]
  bool was_interrupted = false;
  std::string failure;  ///< what ended the run before its time, "" when nothing did

  /// Poses written / frames of the source, skipped ones included.
  double coverage() const;
};

/// Writes trajectory.txt, keyframes.txt, run.json, report.html and, where there is truth, evaluation.json, tracks.json
/// and the plots trajectory.svg and error.svg. Each file is replaced in one step.
void write_run_results(const std::filesystem::path& folder, const RunRecord& record);

/// The summary that is printed at the end.
std::string run_summary_text(const RunRecord& record);

}  // namespace holdfast
