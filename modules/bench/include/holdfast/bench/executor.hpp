// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "holdfast/bench/run_scheduler.hpp"

namespace holdfast {

/// Executes runs of a plan somewhere: here, or on the nodes of a cluster. A run has ended when its folder holds its
/// result, from where it is read: an executor reports the end and carries no results. Used by one thread.
class Executor {
 public:
  virtual ~Executor() = default;
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  /// Takes runs, by their place in the plan and in the order of execution. Called once.
  virtual void submit(const std::vector<std::size_t>& runs) = 0;
  /// Waits for at most so long [s] and returns runs that have ended since the last call, each once. Throws Error when a
  /// run cannot be brought to an end.
  virtual std::vector<std::size_t> wait(double seconds) = 0;
  /// Ends what is running and forgets what is waiting. Runs without a result leave nothing behind.
  virtual void cancel() = 0;

 protected:
  Executor() = default;
};

/// Child processes of this one.
std::unique_ptr<Executor> make_local_executor(const RunPlan& plan, const BenchOptions& options);
/// A job array of Slurm, whose tasks call `options.run_command` with the run's id. The folder of the benchmark must be
/// the same on all nodes. It keeps its scripts and lists in output/slurm, and finds jobs there again that an earlier
/// process submitted.
std::unique_ptr<Executor> make_slurm_executor(const RunPlan& plan, const BenchOptions& options);

/// Executes one run of the plan in this process's machine, as a task of an executor: nothing is done if it has its
/// result already. Returns whether the run has a result then.
bool execute_run(const RunPlan& plan, std::size_t run, const BenchOptions& options);

/// Whether the folder of a run holds the result of its present request.
bool has_result(const RunPlan& plan, const PlannedRun& run, const std::filesystem::path& output);

}  // namespace holdfast
