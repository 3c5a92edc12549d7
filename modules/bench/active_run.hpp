// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>

#include "holdfast/bench/machine_load.hpp"
#include "holdfast/bench/process.hpp"
#include "holdfast/bench/run_scheduler.hpp"

namespace holdfast {

/// A run with a running process, in a hidden folder next to its final folder.
class ActiveRun {
 public:
  ActiveRun(const RunPlan& plan, const PlannedRun& run, const BenchOptions& options);

  const PlannedRun& run() const { return run_; }
  /// Returns whether its process has ended; after its time limit, asks it to end and then kills it.
  bool poll();
  /// After poll() returned true: whether somebody else's signal ended the process.
  bool was_terminated() const;
  /// Marks that another run is executed concurrently.
  void set_beside() { cost_.alone = false; }
  /// After poll() returned true: evaluates, writes the result and renames the folder.
  void complete();
  /// Asks the process to end.
  void terminate() { process_.terminate(); }
  /// Kills the process and removes the folder of an incomplete run.
  void discard();

  const RunResult& result() const { return result_; }
  const RunCost& cost() const { return cost_; }

 private:
  static Process start(const RunPlan& plan, const PlannedRun& run, const RecordedSequence& sequence,
                       const BenchOptions& options, const std::filesystem::path& folder);
  void judge_end();
  void take_load();
  void evaluate_external();

  const RunPlan& plan_;
  const PlannedRun& run_;
  std::filesystem::path output_;
  double grace_;
  std::filesystem::path final_folder_, folder_;
  RecordedSequence sequence_;  ///< that an external system gets
  RunResult result_;
  RunCost cost_;
  bool out_of_time_ = false;
  MachineLoad load_at_start_ = machine_load();
  Process process_;
};

/// Hidden folders of incomplete runs below `runs`.
void remove_incomplete_runs(const std::filesystem::path& runs);

/// The folder of a run.
std::filesystem::path folder_of(const PlannedRun& run, const std::filesystem::path& output);

}  // namespace holdfast
