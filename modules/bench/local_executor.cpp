// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "active_run.hpp"
#include "holdfast/bench/executor.hpp"
#include "recorded_copies.hpp"

namespace holdfast {

namespace {

/// Starts runs in their order, with a limited number of concurrent runs.
class LocalExecutor final : public Executor {
 public:
  LocalExecutor(const RunPlan& plan, const BenchOptions& options) : plan_(plan), options_(options) {}

  void submit(const std::vector<std::size_t>& runs) override {
    waiting_.assign(runs.rbegin(), runs.rend());  // the next one is at the back
  }

  std::vector<std::size_t> wait(double seconds) override {
    while (may_start()) start();
    wait_for_processes(seconds);
    std::vector<std::size_t> ended;
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
      ended.push_back(active.index);
    }
    return ended;
  }

  void cancel() override {
    waiting_.clear();
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

  const RunPlan& plan_;
  const BenchOptions& options_;
  std::vector<std::size_t> waiting_;
  std::vector<Active> active_;
};

}  // namespace

std::unique_ptr<Executor> make_local_executor(const RunPlan& plan, const BenchOptions& options) {
  return std::make_unique<LocalExecutor>(plan, options);
}

bool execute_run(const RunPlan& plan, std::size_t index, const BenchOptions& options) {
  const PlannedRun& run = plan.runs[index];
  if (has_result(plan, run, options.output)) return true;
  if (!make_copies(plan, {index}, options)) return false;
  ActiveRun active(plan, run, options);
  // Only a run that was promised a machine of its own is known to be alone there.
  if (!run.alone) active.set_beside();
  while (!active.poll()) {
    if (options.stop()) {
      active.terminate();
      const Stopwatch since;
      while (!active.poll() && since.seconds() < options.grace) wait_for_processes(0.1);
      active.discard();
      return false;
    }
    wait_for_processes(0.1);
  }
  // A cluster ends a job by a signal to all of its processes, and this one may be the last to get it.
  constexpr double lateness = 2.0;  // s
  const Stopwatch since_end;
  while (active.was_terminated() && !options.stop() && since_end.seconds() < lateness) wait_for_processes(0.1);
  if (options.stop()) {
    active.discard();
    return false;
  }
  active.complete();
  return true;
}

}  // namespace holdfast
