// SPDX-License-Identifier: BSD-3-Clause
#include "process_segmenter.hpp"

#include <dlfcn.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <optional>
#include <utility>

#include "holdfast/core/error.hpp"
#include "messages.hpp"

extern "C" char** environ;

namespace holdfast::python_plugin {

namespace {

constexpr std::size_t most_failures = 3;  // in succession

std::filesystem::path worker_program() {
  Dl_info library = {};
  if (dladdr(reinterpret_cast<void*>(&worker_program), &library) == 0 || library.dli_fname == nullptr)
    throw Error("segmenter 'python': the library of the segmenter has no file name, so that its process is not found");
  return std::filesystem::absolute(library.dli_fname).parent_path() / "holdfast_python_worker";
}

std::string seconds_text(double seconds) {
  char text[32];
  std::snprintf(text, sizeof(text), "%g s", seconds);
  return text;
}

std::string end_text(int status) {
  if (WIFSIGNALED(status))
    return "was ended by signal " + std::to_string(WTERMSIG(status)) + " (" + strsignal(WTERMSIG(status)) + ")";
  return "ended with exit code " + std::to_string(WEXITSTATUS(status));
}

[[noreturn]] void rethrow(MessageReader& reader) {
  const std::string file = reader.text();
  const auto line = static_cast<int>(reader.number()), column = static_cast<int>(reader.number());
  throw InputError({file, line, column}, reader.text());
}

}  // namespace

class ProcessSegmenter::Worker {
 public:
  explicit Worker(const PythonSettings& settings) {
    int ends[2] = {-1, -1};
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
      throw Error(std::string("segmenter 'python': no socket for its process: ") + std::strerror(errno));
    socket_ = ends[0];
    const std::string program = worker_program().string();
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], worker_socket);
    char* const arguments[] = {const_cast<char*>(program.c_str()), nullptr};
    const int error = posix_spawn(&process_, program.c_str(), &actions, nullptr, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    if (error != 0) {
      close(socket_);
      throw Error("segmenter 'python': its process " + program + " cannot be started: " + std::strerror(error));
    }
    MessageWriter order(Message::ready);
    order.text(settings.file.string());
    order.text(settings.colour_order);
    order.number(static_cast<std::int64_t>(settings.parameters.size()));
    for (const auto& [name, value] : settings.parameters) order.text(name), order.text(value);
    send_message(socket_, order.bytes());
  }
  ~Worker() { end(); }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// The answer to a message, within `seconds`; nothing if the process failed: failure() says how.
  std::optional<MessageReader> ask(const std::string& message, double seconds) {
    if (!message.empty()) send_message(socket_, message);  // a process that is gone does not answer
    std::string bytes;
    const Arrival arrival = receive_message(socket_, seconds, bytes);
    if (arrival == Arrival::arrived) return MessageReader(std::move(bytes));
    failure_ = arrival == Arrival::late ? "took longer than " + seconds_text(seconds) + " and was ended" : "";
    const int status = end();
    if (failure_.empty()) failure_ = end_text(status);
    return std::nullopt;
  }
  const std::string& failure() const { return failure_; }

  static constexpr int worker_socket = 3;

 private:
  /// Ends the process, which has this long to end by itself after its socket was closed.
  int end() {
    if (process_ <= 0) return 0;
    close(socket_);
    int status = 0;
    constexpr int most_waits = 200;
    constexpr useconds_t wait = 10000;
    bool has_ended = false;
    for (int i = 0; i < most_waits && !has_ended && failure_.empty(); ++i) {
      has_ended = waitpid(process_, &status, WNOHANG) == process_;
      if (!has_ended) usleep(wait);
    }
    if (!has_ended) {
      kill(process_, SIGKILL);
      waitpid(process_, &status, 0);
    }
    process_ = -1;
    return status;
  }

  int socket_ = -1;
  pid_t process_ = -1;
  std::string failure_;
};

ProcessSegmenter::ProcessSegmenter(const PythonSettings& settings, const CreationContext&) : settings_(settings) {
  settings_.file = std::filesystem::absolute(settings.file).lexically_normal();
  start();
}

ProcessSegmenter::~ProcessSegmenter() = default;

void ProcessSegmenter::start() {
  worker_ = std::make_unique<Worker>(settings_);
  std::optional<MessageReader> answer = worker_->ask("", 0.0);
  if (!answer) {
    const std::string failure = worker_->failure();
    worker_.reset();
    throw InputError({settings_.file.string()}, "its process " + failure +
                                                    " before it was ready; expected `class "
                                                    "Segmenter` to be made; what it printed stands above");
  }
  if (answer->kind() == Message::error) rethrow(*answer);
  for (std::vector<std::string>* names : {&classes_, &movable_}) {
    std::vector<std::string> found(static_cast<std::size_t>(answer->number()));
    for (std::string& name : found) name = answer->text();
    if (frames_ == 0) *names = std::move(found);  // constant after construction
  }
}

void ProcessSegmenter::count_failure(const std::string& what) {
  ++failures_, ++failures_in_succession_;
  last_failure_ = what;
  if (failures_in_succession_ >= most_failures)
    throw InputError({settings_.file.string()},
                     "its process " + what + "; this happened for " + std::to_string(most_failures) +
                         " frames in succession; run the file with `process: shared`, or alone, to find the reason");
}

Segmentation ProcessSegmenter::segment(const SensorFrame& frame) {
  ++frames_;
  if (!worker_) start();
  MessageWriter message(Message::frame);
  message.number(static_cast<std::int64_t>(frame.index));
  message.image(frame.colour);
  std::optional<MessageReader> answer = worker_->ask(message.bytes(), settings_.timeout);
  if (!answer) {
    const std::string failure = worker_->failure() + " at frame " + std::to_string(frame.index);
    worker_.reset();
    count_failure(failure);
    return {};
  }
  if (answer->kind() == Message::error) rethrow(*answer);
  failures_in_succession_ = 0;
  Segmentation result;
  result.labels = answer->image(), result.confidence = answer->image(), result.instances = answer->image();
  result.found.resize(static_cast<std::size_t>(answer->number()));
  for (Instance& instance : result.found) {
    instance.label = static_cast<std::uint8_t>(answer->number());
    instance.score = static_cast<float>(answer->real());
    for (float* side : {&instance.box.x, &instance.box.y, &instance.box.width, &instance.box.height})
      *side = static_cast<float>(answer->real());
  }
  return result;
}

Warnings ProcessSegmenter::warnings() const {
  if (failures_ == 0) return {};
  return {{{settings_.file.string()},
           "its process failed at " + std::to_string(failures_) + " of " + std::to_string(frames_) +
               " segmented frames, which have no mask, and was started anew; the last time it " + last_failure_ +
               "; run the file with `process: shared`, or alone, to find the reason"}};
}

}  // namespace holdfast::python_plugin
