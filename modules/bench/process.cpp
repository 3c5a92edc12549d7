// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/process.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>

#include "holdfast/core/error.hpp"

namespace holdfast {

namespace {

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// Everything that the child needs, made before fork(): between fork() and exec() only system calls are safe.
struct ChildPlan {
  std::vector<std::string> words, variables;
  std::vector<char*> arguments, environment;
  std::string folder, log;

  explicit ChildPlan(const ProcessRequest& request)
      : words(request.command), folder(request.folder.string()), log(request.log.string()) {
    for (char** variable = environ; *variable != nullptr; ++variable) {
      const std::string text = *variable;
      const std::string name = text.substr(0, text.find('='));
      bool is_replaced = false;
      for (const auto& [key, value] : request.environment) is_replaced = is_replaced || key == name;
      if (!is_replaced) variables.push_back(text);
    }
    for (const auto& [name, value] : request.environment) variables.push_back(name + "=" + value);
    for (std::string& word : words) arguments.push_back(word.data());
    for (std::string& variable : variables) environment.push_back(variable.data());
    arguments.push_back(nullptr);
    environment.push_back(nullptr);
  }
};

[[noreturn]] void run_child(const ChildPlan& plan, pid_t parent, int error_pipe) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(127);  // it died before it could be watched
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  for (const int signal : {SIGINT, SIGTERM, SIGPIPE}) std::signal(signal, SIG_DFL);
  const int input = open("/dev/null", O_RDONLY);
  const int log = open(plan.log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
  if (input >= 0) dup2(input, STDIN_FILENO);
  if (log >= 0) {
    dup2(log, STDOUT_FILENO);
    dup2(log, STDERR_FILENO);
  }
  if (plan.folder.empty() || chdir(plan.folder.c_str()) == 0)
    execvpe(plan.arguments.front(), plan.arguments.data(), plan.environment.data());
  const int reason = errno;
  [[maybe_unused]] const ssize_t written = write(error_pipe, &reason, sizeof(reason));
  _exit(127);
}

void block_child_signal() {
  sigset_t child;
  sigemptyset(&child);
  sigaddset(&child, SIGCHLD);
  sigprocmask(SIG_BLOCK, &child, nullptr);  // so that wait_for_processes() misses none
}

}  // namespace

Process::Process(const ProcessRequest& request) {
  HOLDFAST_CHECK(!request.command.empty(), "a command without a program");
  block_child_signal();
  const ChildPlan plan(request);
  int pipe_ends[2];
  if (pipe2(pipe_ends, O_CLOEXEC) != 0) throw Error(std::string("a pipe cannot be made: ") + std::strerror(errno));
  const pid_t parent = getpid();
  id_ = fork();
  if (id_ == 0) run_child(plan, parent, pipe_ends[1]);
  const int fork_error = errno;
  close(pipe_ends[1]);
  start_error_pipe_ = pipe_ends[0];
  if (id_ < 0) {
    close(start_error_pipe_);
    throw Error(std::string("a process cannot be started: ") + std::strerror(fork_error));
  }
  setpgid(id_, id_);  // whoever comes first
}

Process::Process(Process&& other) noexcept
    : id_(other.id_), start_error_pipe_(other.start_error_pipe_), watch_(other.watch_) {
  other.id_ = -1;
  other.start_error_pipe_ = -1;
}

Process& Process::operator=(Process&& other) noexcept {
  std::swap(id_, other.id_);
  std::swap(start_error_pipe_, other.start_error_pipe_);
  std::swap(watch_, other.watch_);
  return *this;
}

Process::~Process() {
  if (id_ > 0) {
    kill();
    waitpid(id_, nullptr, 0);
  }
  if (start_error_pipe_ >= 0) close(start_error_pipe_);
}

std::optional<ProcessEnd> Process::poll() {
  HOLDFAST_CHECK(id_ > 0, "the process has ended and was told so");
  int status = 0;
  rusage usage{};
  pid_t ended = 0;
  do {
    ended = wait4(id_, &status, WNOHANG, &usage);
  } while (ended < 0 && errno == EINTR);
  if (ended == 0) return std::nullopt;
  ProcessEnd end;
  end.wall_seconds = watch_.seconds();
  int reason = 0;
  end.was_started = read(start_error_pipe_, &reason, sizeof(reason)) != static_cast<ssize_t>(sizeof(reason));
  if (WIFEXITED(status)) end.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) end.signal = WTERMSIG(status);
  end.user_seconds = seconds_of(usage.ru_utime);
  end.system_seconds = seconds_of(usage.ru_stime);
  end.peak_memory = static_cast<std::size_t>(usage.ru_maxrss) * 1024;
  kill();  // what it left running
  id_ = -1;
  return end;
}

void Process::signal_group(int signal) {
  if (id_ > 0) ::kill(-id_, signal);
}
void Process::terminate() { signal_group(SIGTERM); }
void Process::kill() { signal_group(SIGKILL); }

void wait_for_processes(double seconds) {
  sigset_t child;
  sigemptyset(&child);
  sigaddset(&child, SIGCHLD);
  timespec most{};
  most.tv_sec = static_cast<time_t>(seconds);
  most.tv_nsec = static_cast<long>((seconds - static_cast<double>(most.tv_sec)) * 1e9);
  sigtimedwait(&child, nullptr, &most);
}

}  // namespace holdfast
