// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "holdfast/bench/run_plan.hpp"
#include "holdfast/bench/run_result.hpp"

namespace holdfast {

/// Where and how the runs of a bench are started.
struct BenchOptions {
  std::filesystem::path output;   ///< results of run ID go to output/runs/ID
  std::filesystem::path program;  ///< ours, for `holdfast run`
  int jobs = 1;                   ///< runs at once; runs that stand alone do so whatever this says
  double grace = 10.0;            ///< between asking a process to end and ending it [s]
  /// Asked several times a second: stop, and leave what is unfinished undone?
  std::function<bool()> stop = [] { return false; };
};

/// Where a bench stands when a run has ended.
struct BenchProgress {
  std::size_t done = 0;  ///< those found finished included
  std::size_t total = 0;
  double seconds_left = 0.0;  ///< if the rest goes as this session went
};

/// What came of every run of a plan, by its place there.
struct BenchResults {
  std::vector<std::optional<RunResult>> results;
  std::vector<std::optional<RunCost>> costs;
  std::size_t kept = 0;  ///< found finished
  bool was_stopped = false;

  bool is_complete() const;
};

/// Files in the folder of a run that the bench itself writes; result_file last, so that a folder without it is none of
/// a finished run.
inline constexpr const char* result_file = "result.json";
inline constexpr const char* cost_file = "cost.json";
inline constexpr const char* log_file = "log.txt";

/// The results in a folder: of every planned run that finished with the same request as now. The others are nothing.
BenchResults find_results(const RunPlan& plan, const std::filesystem::path& output);

/// Runs what is not finished yet, each run in a process of its own. A run works in a hidden folder that is renamed when
/// its result is complete, so the folder of a run is there as a whole or not at all, whenever we are killed. Whatever
/// becomes of a run is its result; the others go on. The plan must have nothing missing. Throws Error when another
/// bench works in the folder, InputError when files cannot be written.
BenchResults run_bench(
    const RunPlan& plan, const BenchOptions& options,
    const std::function<void(const PlannedRun&, const RunResult&, const RunCost&, const BenchProgress&)>& ended);

}  // namespace holdfast
