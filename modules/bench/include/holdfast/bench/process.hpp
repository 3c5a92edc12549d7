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

/// How a process ended, with what the operating system counted for it and for those of its children that it waited for.
struct ProcessEnd {
  bool was_started = true;
  int exit_code = 0;  ///< meaningless when a signal ended it
  int signal = 0;     ///< 0 = it ended by itself
  double wall_seconds = 0.0;
  double user_seconds = 0.0;
  double system_seconds = 0.0;
  std::size_t peak_memory = 0;  ///< resident, of its largest process [bytes]
};

/// A running process, the head of a process group of its own: Ctrl-C on our terminal does not reach it, and a signal
/// meets its children too. It ends when we end, however that happens (Linux's parent-death signal; its children are not
/// covered). An object that goes kills the group. Used by one thread.
class Process {
 public:
  /// What cannot be started ends at once, with was_started false and the reason in the log.
  explicit Process(const ProcessRequest& request);
  ~Process();
  Process(Process&& other) noexcept;
  Process& operator=(Process&& other) noexcept;

  /// How it ended; nothing while it runs. Does not wait.
  std::optional<ProcessEnd> poll();
  double seconds() const { return watch_.seconds(); }
  /// Asks the group to end (SIGTERM), or ends it (SIGKILL).
  void terminate();
  void kill();

 private:
  void signal_group(int signal);

  pid_t id_ = -1;  ///< -1 = ended
  int start_error_pipe_ = -1;
  Stopwatch watch_;
};

/// Waits until one of our processes may have ended or a signal came, at most so long [s].
void wait_for_processes(double seconds);

}  // namespace holdfast
