// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <exception>
#include <functional>
#include <string>
#include <thread>
#include <utility>

#include "holdfast/core/bounded_queue.hpp"
#include "holdfast/core/thread_name.hpp"
#include "holdfast/core/worker_counts.hpp"

namespace holdfast {

/// A thread that executes jobs in their order of arrival. An exception of a job ends the thread: queued jobs are
/// discarded, and rethrow() throws the exception. Debuggers and `top -H` show the name of the thread.
template <class Job>
class Worker {
 public:
  Worker(std::string name, std::size_t capacity, std::function<void(Job&)> work)
      : name_(std::move(name)), work_(std::move(work)), queue_(capacity), thread_([this] { run(); }) {}
  /// Discards queued jobs and waits for the job in progress.
  ~Worker() {
    queue_.close(true);
    if (thread_.joinable()) thread_.join();
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  BoundedQueue<Job>& queue() { return queue_; }
  const BoundedQueue<Job>& queue() const { return queue_; }
  /// Executes the queued jobs, then ends the thread.
  void finish() {
    queue_.close();
    if (thread_.joinable()) thread_.join();
  }
  /// Rethrows the exception of a job, once.
  void rethrow() {
    const std::lock_guard lock(mutex_);
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  }
  WorkerCounts counts() const {
    const std::lock_guard lock(mutex_);
    return {name_, queue_.counts(), busy_seconds_};
  }

 private:
  void run() {
    name_this_thread(name_);
    while (std::optional<Job> job = queue_.pop()) {
      const Stopwatch watch;
      std::exception_ptr failure;
      try {
        work_(*job);
      } catch (...) {
        failure = std::current_exception();
      }
      const std::lock_guard lock(mutex_);
      busy_seconds_ += watch.seconds();
      if (!failure) continue;
      failure_ = failure;
      queue_.close(true);
      return;
    }
  }

  std::string name_;
  std::function<void(Job&)> work_;
  BoundedQueue<Job> queue_;
  mutable std::mutex mutex_;
  std::exception_ptr failure_;
  double busy_seconds_ = 0.0;
  std::thread thread_;  // last: it uses all the others
};

}  // namespace holdfast
