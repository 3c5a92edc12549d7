// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/run_scheduler.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <memory>

#include "active_run.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast {

namespace fs = std::filesystem;

namespace {

/// Allows one benchmark at a time in a folder; the lock is released when the process ends.
class FolderLock {
 public:
  explicit FolderLock(const fs::path& folder)
      : file_(open((folder / ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
    if (file_ < 0) throw InputError({folder.string()}, "cannot be written to");
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

std::string content(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

bool is_finished(const RunPlan& plan, const PlannedRun& run, const fs::path& folder) {
  std::error_code ignored;
  const char* request = plan.variants[run.variant].is_external() ? external_request_file : configuration_file;
  return fs::exists(folder / result_file, ignored) && content(folder / request) == run.request;
}

/// Starts runs in their order, with a limited number of concurrent runs.
class RunScheduler {
 public:
  using Ended = std::function<void(const PlannedRun&, const RunResult&, const RunCost&, const BenchProgress&)>;

  RunScheduler(const RunPlan& plan, const BenchOptions& options, const Ended& ended)
      : plan_(plan), options_(options), ended_(ended), results_(find_results(plan, options.output)) {
    for (std::size_t i = 0; i < plan.runs.size(); ++i)
      if (!results_.results[i]) waiting_.push_back(i);
    std::reverse(waiting_.begin(), waiting_.end());  // the next one is at the back
  }

  BenchResults run() {
    while (!waiting_.empty() || !active_.empty()) {
      if (options_.stop()) {
        stop();
        break;
      }
      while (may_start()) start();
      wait_for_processes(0.1);
      take_ended();
    }
    return std::move(results_);
  }

 private:
  struct Active {
    std::size_t index;
    std::unique_ptr<ActiveRun> run;
  };

  bool may_start() const {
    if (waiting_.empty()) return false;
    if (active_.empty()) return true;
    return !plan_.runs[waiting_.back()].alone && !active_.front().run->run().alone &&
           active_.size() < static_cast<std::size_t>(options_.jobs);
  }

  void start() {
    const std::size_t index = waiting_.back();
    active_.push_back({index, std::make_unique<ActiveRun>(plan_, plan_.runs[index], options_)});
    waiting_.pop_back();
    if (active_.size() > 1)
      for (Active& active : active_) active.run->set_beside();
  }

  void take_ended() {
    for (std::size_t i = 0; i < active_.size();) {
      if (!active_[i].run->poll()) {
        ++i;
        continue;
      }
      const Active active = std::move(active_[i]);
      active_.erase(active_.begin() + static_cast<std::ptrdiff_t>(i));
      if (options_.stop()) {  // a signal from the terminal may have ended it
        active.run->discard();
        continue;
      }
      active.run->complete();
      results_.results[active.index] = active.run->result();
      results_.costs[active.index] = active.run->cost();
      ++ended_here_;
      ended_(active.run->run(), active.run->result(), active.run->cost(), progress());
    }
  }

  BenchProgress progress() const {
    const std::size_t left = waiting_.size() + active_.size();
    return {plan_.runs.size() - left, plan_.runs.size(),
            watch_.seconds() / static_cast<double>(ended_here_) * static_cast<double>(left)};
  }

  void stop() {
    results_.was_stopped = true;
    for (Active& active : active_) active.run->terminate();
    const Stopwatch since;
    while (!active_.empty() && since.seconds() < options_.grace) {
      std::erase_if(active_, [](Active& active) {
        if (!active.run->poll()) return false;
        active.run->discard();
        return true;
      });
      if (!active_.empty()) wait_for_processes(0.1);
    }
    for (Active& active : active_) active.run->discard();
    active_.clear();  // ends what is left
  }

  const RunPlan& plan_;
  const BenchOptions& options_;
  const Ended& ended_;
  BenchResults results_;
  std::vector<std::size_t> waiting_;
  std::vector<Active> active_;
  std::size_t ended_here_ = 0;
  Stopwatch watch_;
};

}  // namespace

bool BenchResults::is_complete() const {
  return std::all_of(results.begin(), results.end(), [](const auto& result) { return result.has_value(); });
}

BenchResults find_results(const RunPlan& plan, const fs::path& output) {
  BenchResults found;
  found.results.resize(plan.runs.size());
  found.costs.resize(plan.runs.size());
  for (std::size_t i = 0; i < plan.runs.size(); ++i) {
    const fs::path folder = folder_of(plan.runs[i], output);
    if (!is_finished(plan, plan.runs[i], folder)) continue;
    found.results[i] = read_run_result(folder / result_file);
    found.costs[i] = read_run_cost(folder / cost_file);
    ++found.kept;
  }
  return found;
}

BenchResults run_bench(const RunPlan& plan, const BenchOptions& options, const RunScheduler::Ended& ended) {
  HOLDFAST_CHECK(plan.missing.empty(), plan.missing.size() << " things are missing");
  std::error_code error;
  fs::create_directories(options.output / "runs", error);
  if (!fs::is_directory(options.output / "runs", error))
    throw InputError({options.output.string()}, "the output folder cannot be made");
  const FolderLock lock(options.output);
  remove_incomplete_runs(options.output / "runs");
  return RunScheduler(plan, options, ended).run();
}

}  // namespace holdfast
