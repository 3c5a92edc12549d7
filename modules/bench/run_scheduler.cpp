// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/run_scheduler.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <memory>

#include "active_run.hpp"
#include "holdfast/bench/executor.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/system_reason.hpp"
#include "recorded_copies.hpp"
#include "run_folders.hpp"

namespace holdfast {

namespace fs = std::filesystem;

namespace {

/// Allows one benchmark at a time in a folder; the lock is released when the process ends.
class FolderLock {
 public:
  explicit FolderLock(const fs::path& folder)
      : file_(open((folder / ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
    if (file_ < 0) throw InputError({folder.string()}, "cannot be written to: " + system_reason(errno));
    if (flock(file_, LOCK_EX | LOCK_NB) != 0) {
      close(file_);
      throw InputError({folder.string()}, "another bench is at work in this folder; wait for it, or name another one");
    }
  }
  ~FolderLock() { close(file_); }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int file_;
};

bool is_finished(const RunPlan& plan, const PlannedRun& run, const fs::path& folder) {
  std::error_code ignored;
  const char* request = plan.variants[run.variant].is_external() ? external_request_file : configuration_file;
  return fs::exists(folder / result_file, ignored) && content_of(folder / request) == run.request;
}

}  // namespace

bool BenchResults::is_complete() const {
  return std::all_of(results.begin(), results.end(), [](const auto& result) { return result.has_value(); });
}

bool has_result(const RunPlan& plan, const PlannedRun& run, const fs::path& output) {
  return is_finished(plan, run, folder_of(run, output));
}

namespace {

void read_results(const RunPlan& plan, const fs::path& output, std::size_t index, BenchResults& results) {
  const fs::path folder = folder_of(plan.runs[index], output);
  results.results[index] = read_run_result(folder / result_file);
  results.costs[index] = read_run_cost(folder / cost_file);
}

}  // namespace

BenchResults find_results(const RunPlan& plan, const fs::path& output) {
  BenchResults found;
  found.results.resize(plan.runs.size());
  found.costs.resize(plan.runs.size());
  for (std::size_t i = 0; i < plan.runs.size(); ++i) {
    if (!has_result(plan, plan.runs[i], output)) continue;
    read_results(plan, output, i, found);
    ++found.kept;
  }
  return found;
}

namespace {

std::unique_ptr<Executor> make_executor(const RunPlan& plan, const BenchOptions& options) {
  return options.executor == ExecutorKind::slurm ? make_slurm_executor(plan, options)
                                                 : make_local_executor(plan, options);
}

}  // namespace

BenchResults run_bench(
    const RunPlan& plan, const BenchOptions& options,
    const std::function<void(const PlannedRun&, const RunResult&, const RunCost&, const BenchProgress&)>& ended) {
  HOLDFAST_CHECK(plan.missing.empty(), plan.missing.size() << " things are missing");
  std::error_code error;
  fs::create_directories(options.output / "runs", error);
  if (!fs::is_directory(options.output / "runs", error))
    throw InputError({options.output.string()}, "the output folder cannot be made");
  const FolderLock lock(options.output);
  // Those of a cluster may be at work.
  if (options.executor == ExecutorKind::local) remove_incomplete_runs(options.output / "runs");
  BenchResults results = find_results(plan, options.output);
  std::vector<std::size_t> waiting;
  for (std::size_t i = 0; i < plan.runs.size(); ++i)
    if (!results.results[i]) waiting.push_back(i);
  const auto forget_copies = [&] {
    if (!options.keep_copies) remove_copies(options.output);
  };
  if (waiting.empty()) {
    forget_copies();
    return results;
  }
  if (!make_copies(plan, waiting, options)) {
    results.was_stopped = true;
    return results;
  }

  const Stopwatch watch;
  const auto executor = make_executor(plan, options);
  executor->submit(waiting);
  std::size_t ended_here = 0;
  while (ended_here < waiting.size()) {
    if (options.stop()) {
      results.was_stopped = true;
      executor->cancel();
      break;
    }
    for (const std::size_t index : executor->wait(0.1)) {
      read_results(plan, options.output, index, results);
      ++ended_here;
      const std::size_t left = waiting.size() - ended_here;
      ended(plan.runs[index], *results.results[index], *results.costs[index],
            {plan.runs.size() - left, plan.runs.size(),
             watch.seconds() / static_cast<double>(ended_here) * static_cast<double>(left)});
    }
  }
  if (!results.was_stopped) forget_copies();
  if (options.executor != ExecutorKind::local && !results.was_stopped) remove_incomplete_runs(options.output / "runs");
  return results;
}

}  // namespace holdfast
