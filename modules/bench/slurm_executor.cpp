// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <sstream>

#include "active_run.hpp"
#include "holdfast/bench/executor.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/text_file.hpp"
#include "slurm_commands.hpp"

namespace holdfast {

namespace fs = std::filesystem;

namespace {

constexpr int most_attempts = 3;

/// A run in the queue: task `task` of batch `batch`.
struct Task {
  std::size_t batch = 0;
  std::size_t task = 0;
  friend auto operator<=>(const Task&, const Task&) = default;
};

/// Batches are folders slurm/batch-N with the ids of their runs, one per line. A batch is written before it is
/// submitted and its jobs carry its number in their name, so that whatever dies in between, the queue and the folder
/// say together which runs are under way.
class SlurmExecutor final : public Executor {
 public:
  SlurmExecutor(const RunPlan& plan, const BenchOptions& options)
      : plan_(plan), options_(options), folder_(options.output / "slurm"), job_name_(slurm_job_name(options.output)) {
    for (std::size_t i = 0; i < plan.runs.size(); ++i) place_of_[plan.runs[i].id] = i;
    std::error_code error;
    fs::create_directories(folder_, error);
    if (!fs::is_directory(folder_, error)) throw InputError({folder_.string()}, "the folder for jobs cannot be made");
  }

  void submit(const std::vector<std::size_t>& runs) override {
    wanted_.insert(runs.begin(), runs.end());
    read_batches();
    std::vector<std::size_t> missing;
    std::set<std::size_t> under_way;
    for (const auto& [task, run] : find_queue()) {
      if (!wanted_.contains(run)) continue;
      active_[task] = run;
      under_way.insert(run);
    }
    std::copy_if(runs.begin(), runs.end(), std::back_inserter(missing),
                 [&](std::size_t run) { return !under_way.contains(run); });
    submit_batches(missing);
  }

  std::vector<std::size_t> wait(double seconds) override {
    wait_for_processes(seconds);
    if (since_query_.seconds() < options_.slurm.poll_seconds) return {};
    since_query_ = {};
    const std::optional<std::vector<QueuedTask>> queue = query_slurm(job_name_, folder_);
    if (!queue) return {};  // the controller is away: jobs go on, and it comes back
    std::set<Task> present;
    for (const QueuedTask& queued : *queue) present.insert({queued.batch, queued.task});
    std::vector<std::size_t> ended, lost;
    for (auto entry = active_.begin(); entry != active_.end();) {
      const auto [task, run] = *entry;
      if (has_result(plan_, plan_.runs[run], options_.output)) {
        // It may still be in the queue for a moment.
        if (wanted_.erase(run) > 0) ended.push_back(run);
        entry = active_.erase(entry);
      } else if (present.contains(task) || ++absences_[task] < absences_of_a_lost_task) {
        ++entry;
      } else {
        lost.push_back(run);
        entry = active_.erase(entry);
      }
    }
    submit_again(lost);
    return ended;
  }

  void cancel() override {
    cancel_slurm(job_name_, folder_, batches_.size());
    const Stopwatch since;
    while (since.seconds() < 3.0 * options_.grace) {
      const auto queue = query_slurm(job_name_, folder_);
      if (queue && queue->empty()) break;
      wait_for_processes(0.5);
    }
    active_.clear();
    remove_incomplete_runs(options_.output / "runs");
  }

 private:
  /// A task that ended is seen in its folder a little later on a network file system.
  static constexpr int absences_of_a_lost_task = 3;

  void read_batches() {
    for (std::size_t batch = 0; fs::exists(batch_folder(batch) / "runs.txt"); ++batch) {
      LineReader lines(batch_folder(batch) / "runs.txt", "the runs of a job, one a line");
      std::vector<std::string>& ids = batches_.emplace_back();
      for (std::string id; lines.next(id);) ids.push_back(id);
    }
  }
  fs::path batch_folder(std::size_t batch) const { return folder_ / ("batch-" + std::to_string(batch)); }

  /// Runs of the plan that an earlier process left in the queue.
  std::map<Task, std::size_t> find_queue() {
    std::map<Task, std::size_t> found;
    if (batches_.empty()) return found;
    std::optional<std::vector<QueuedTask>> queue;
    // To submit anything again without knowing the queue would run it twice.
    while (!(queue = query_slurm(job_name_, folder_))) {
      if (options_.stop()) return found;
      wait_for_processes(options_.slurm.poll_seconds);
    }
    for (const QueuedTask& queued : *queue) {
      if (queued.batch >= batches_.size() || queued.task >= batches_[queued.batch].size()) continue;
      const auto place = place_of_.find(batches_[queued.batch][queued.task]);
      if (place != place_of_.end()) found[{queued.batch, queued.task}] = place->second;
    }
    return found;
  }

  /// Runs that need a node alone are batches of their own.
  void submit_batches(const std::vector<std::size_t>& runs) {
    for (const bool alone : {false, true}) {
      std::vector<std::size_t> batch;
      for (const std::size_t run : runs) {
        if (plan_.runs[run].alone != alone) continue;
        batch.push_back(run);
        if (batch.size() < options_.slurm.array_size) continue;
        submit_batch(batch, alone);
        batch.clear();
      }
      if (!batch.empty()) submit_batch(batch, alone);
    }
  }

  void submit_batch(const std::vector<std::size_t>& runs, bool alone) {
    const std::size_t batch = batches_.size();
    const fs::path folder = batch_folder(batch);
    std::error_code error;
    fs::create_directories(folder, error);
    std::string list;
    std::vector<std::string>& ids = batches_.emplace_back();
    for (const std::size_t run : runs) {
      ids.push_back(plan_.runs[run].id);
      list += ids.back() + "\n";
    }
    write_file_atomically(folder / "runs.txt", list);
    write_file_atomically(folder / "job.sh", slurm_script(options_.run_command, folder / "runs.txt"));
    submit_slurm(options_.slurm, job_name_ + "-" + std::to_string(batch), folder, runs.size(), alone);
    for (std::size_t task = 0; task < runs.size(); ++task) active_[{batch, task}] = runs[task];
  }

  void submit_again(const std::vector<std::size_t>& lost) {
    for (const std::size_t run : lost)
      if (++attempts_[run] >= most_attempts)
        throw Error("the run " + plan_.runs[run].id + " ended " + std::to_string(most_attempts) +
                    " times in Slurm without a result; see the last log in " + folder_.string() +
                    ", and whether the nodes have the program, the data and the folder of the bench");
    if (!lost.empty()) submit_batches(lost);
  }

  const RunPlan& plan_;
  const BenchOptions& options_;
  fs::path folder_;
  std::string job_name_;
  std::map<std::string, std::size_t> place_of_;
  std::vector<std::vector<std::string>> batches_;  ///< ids of the runs of each
  std::map<Task, std::size_t> active_;
  std::map<Task, int> absences_;
  std::map<std::size_t, int> attempts_;
  std::set<std::size_t> wanted_;
  Stopwatch since_query_;
};

}  // namespace

std::unique_ptr<Executor> make_slurm_executor(const RunPlan& plan, const BenchOptions& options) {
  return std::make_unique<SlurmExecutor>(plan, options);
}

}  // namespace holdfast
