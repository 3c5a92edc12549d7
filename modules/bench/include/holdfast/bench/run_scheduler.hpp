// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/bench/run_plan.hpp"
#include "holdfast/bench/run_result.hpp"

namespace holdfast {

/// Where runs are executed; see executor.hpp.
enum class ExecutorKind { local, slurm };

/// Options of sbatch; an empty text leaves one out.
struct SlurmOptions {
  std::string partition;
  std::string account;
  std::string time;               ///< limit of a run, as sbatch takes it: 30 or 1:30:00
  std::string memory;             ///< of a run: 4G
  std::string constraint;         ///< of nodes: one node type, so that times can be compared
  int processors = 0;             ///< of a run; 0 = Slurm's default
  std::size_t array_size = 1000;  ///< most runs of an array; at most MaxArraySize of slurm.conf
  double poll_seconds = 5.0;      ///< between two looks at the queue
};

/// Options for the execution of the runs of a benchmark.
struct BenchOptions {
  std::filesystem::path output;      ///< results of run ID go to output/runs/ID
  std::vector<std::string> program;  ///< command line that starts the program `holdfast`, without its arguments
  int jobs = 1;  ///< maximum number of concurrent runs; does not apply to runs that must be executed alone
  ExecutorKind executor = ExecutorKind::local;
  SlurmOptions slurm;
  /// Command that executes one run of this benchmark when `--run ID` is added; for executors on other machines.
  std::vector<std::string> run_command;
  bool keep_copies = false;  ///< copies of frames for external systems stay when all runs are done
  double grace = 10.0;       ///< time between asking a process to end and killing it [s]
  /// Polled several times per second; if it returns true, unfinished runs are aborted.
  std::function<bool()> stop = [] { return false; };
};

/// Progress of a benchmark after the end of a run.
struct BenchProgress {
  std::size_t done = 0;  ///< including runs that were finished before
  std::size_t total = 0;
  double seconds_left = 0.0;  ///< extrapolated from this session
};

/// Results of all runs of a plan, by index.
struct BenchResults {
  std::vector<std::optional<RunResult>> results;
  std::vector<std::optional<RunCost>> costs;
  std::size_t kept = 0;  ///< runs that were finished before
  bool was_stopped = false;

  bool is_complete() const;
};

/// Files that the benchmark writes to the folder of a run; result_file is the last one, so that its presence identifies
/// a finished run.
inline constexpr const char* result_file = "result.json";
inline constexpr const char* cost_file = "cost.json";
inline constexpr const char* log_file = "log.txt";

/// Reads the results in a folder of all planned runs that finished with the current request; the others are empty.
BenchResults find_results(const RunPlan& plan, const std::filesystem::path& output);

/// Executes the unfinished runs, each in a separate process. A run works in a hidden folder that is renamed when its
/// result is complete, so that the folder of a run is either complete or absent, even if the benchmark is killed. A
/// failed run is a result; the other runs continue. RunPlan::missing must be empty. Throws Error if another benchmark
/// uses the folder, InputError if files cannot be written.
BenchResults run_bench(
    const RunPlan& plan, const BenchOptions& options,
    const std::function<void(const PlannedRun&, const RunResult&, const RunCost&, const BenchProgress&)>& ended);

}  // namespace holdfast
