// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "holdfast/bench/run_scheduler.hpp"

namespace holdfast {

/// Executes the runs of a plan on this machine or on a cluster. A run has ended when its folder contains the result;
/// the executor reports only the end. Used by one thread.
class Executor {
 public:
  virtual ~Executor() = default;
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  /// Starts the execution of runs, given by their indices in the plan, in this order. Called once.
  virtual void submit(const std::vector<std::size_t>& runs) = 0;
  /// Waits for at most the given time [s] and returns the runs that have ended since the last call. Throws Error if a
  /// run cannot be executed.
  virtual std::vector<std::size_t> wait(double seconds) = 0;
  /// Ends running and cancels waiting runs. Runs without a result leave no files.
  virtual void cancel() = 0;

 protected:
  Executor() = default;
};

/// Executes runs as child processes.
std::unique_ptr<Executor> make_local_executor(const RunPlan& plan, const BenchOptions& options);
/// A job array of Slurm, whose tasks call `options.run_command` with the run's id. The folder of the benchmark must be
/// the same on all nodes. It keeps its scripts and lists in output/slurm, and finds jobs there again that an earlier
/// process submitted.
std::unique_ptr<Executor> make_slurm_executor(const RunPlan& plan, const BenchOptions& options);

/// Executes one run of the plan on this machine, unless it has a result. Returns whether it has a result afterwards.
bool execute_run(const RunPlan& plan, std::size_t run, const BenchOptions& options);

/// Whether the folder of a run contains the result of its current request.
bool has_result(const RunPlan& plan, const PlannedRun& run, const std::filesystem::path& output);

}  // namespace holdfast
