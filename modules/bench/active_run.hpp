// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>

#include "holdfast/bench/process.hpp"
#include "holdfast/bench/run_desk.hpp"

namespace holdfast {

/// A run while its process lives, in a hidden folder beside the one that it gets in the end.
class ActiveRun {
 public:
  ActiveRun(const RunPlan& plan, const PlannedRun& run, const BenchOptions& options);

  const PlannedRun& run() const { return run_; }
  /// Whether its process has ended; asks it to end, and then ends it, when its time is over.
  bool poll();
  /// Told when another run is beside it.
  void set_beside() { cost_.alone = false; }
  /// Once poll() was true: evaluates, writes the result and gives the folder its name.
  void complete();
  /// Asks the process to end.
  void terminate() { process_.terminate(); }
  /// Ends the process and removes the folder of a run that was not completed.
  void discard();

  const RunResult& result() const { return result_; }
  const RunCost& cost() const { return cost_; }

 private:
  static Process start(const RunPlan& plan, const PlannedRun& run, const BenchOptions& options,
                       const std::filesystem::path& folder);
  void judge_end();
  void evaluate_external();

  const RunPlan& plan_;
  const PlannedRun& run_;
  double grace_;
  std::filesystem::path final_folder_, folder_;
  RunResult result_;
  RunCost cost_;
  bool out_of_time_ = false;
  Process process_;
};

/// Hidden folders of runs that were never completed, below `runs`.
void remove_incomplete_runs(const std::filesystem::path& runs);

/// The folder of a run.
std::filesystem::path folder_of(const PlannedRun& run, const std::filesystem::path& output);

}  // namespace holdfast
