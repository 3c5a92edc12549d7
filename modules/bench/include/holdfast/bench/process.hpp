// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/core/stage_times.hpp"

namespace holdfast {

/// A program to start.
struct ProcessRequest {
  std::vector<std::string> command;  ///< program (searched in PATH when it has no '/') and arguments; no shell
  std::filesystem::path folder;      ///< to run in; empty = ours
  std::vector<std::pair<std::string, std::string>> environment;  ///< added to ours
  std::filesystem::path log;                                     ///< standard output and error go here
};

/// End of a process, with the resources used by it and by its children that it waited for.
struct ProcessEnd {
  bool was_started = true;
  int exit_code = 0;  ///< meaningless when a signal ended it
  int signal = 0;     ///< 0 = it ended by itself
  double wall_seconds = 0.0;
  double user_seconds = 0.0;
  double system_seconds = 0.0;
  std::size_t peak_memory = 0;  ///< resident, of its largest process [bytes]
};

/// A running process with a process group of its own: Ctrl-C in the terminal does not reach it, and signals are sent to
/// its children, too. It is killed when this process ends (parent-death signal of Linux; its children are not). The
/// destructor kills the group. Used by one thread.
class Process {
 public:
  /// A program that cannot be started ends immediately, with was_started false and the reason in the log.
  explicit Process(const ProcessRequest& request);
  ~Process();
  Process(Process&& other) noexcept;
  Process& operator=(Process&& other) noexcept;

  /// The end of the process; empty while it runs. Does not wait.
  std::optional<ProcessEnd> poll();
  double seconds() const { return watch_.seconds(); }
  /// Sends SIGTERM or SIGKILL to the group.
  void terminate();
  void kill();

 private:
  void signal_group(int signal);

  pid_t id_ = -1;  ///< -1 = ended
  int start_error_pipe_ = -1;
  Stopwatch watch_;
};

/// Waits until a child process may have ended or a signal has arrived, at most for the given time [s].
void wait_for_processes(double seconds);

}  // namespace holdfast
