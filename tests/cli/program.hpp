// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace holdfast::test {

inline std::string content(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

struct Outcome {
  int exit_code = -1;
  std::string output, errors;
};

/// The program as users run it, in a folder of its own that goes with the object.
class Program {
 public:
  Program() {
    std::string name = (std::filesystem::temp_directory_path() / "holdfast_cli_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~Program() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  std::string text(const std::string& name) const { return content(path(name)); }
  void write(const std::string& name, const std::string& content) const { std::ofstream(path(name)) << content; }

  /// Starts it; standard output and error go to files, which finish() reads.
  pid_t start(const std::vector<std::string>& arguments) const {
    const std::string output = path("stdout").string(), errors = path("stderr").string();
    std::vector<std::string> words = {HOLDFAST_PROGRAM};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    const pid_t process = fork();
    if (process != 0) return process;
    if (chdir(folder_.c_str()) != 0 || std::freopen(output.c_str(), "w", stdout) == nullptr ||
        std::freopen(errors.c_str(), "w", stderr) == nullptr)
      _exit(126);
    execv(pointers.front(), pointers.data());
    _exit(127);
  }
  Outcome finish(pid_t process) const {
    int status = 0;
    waitpid(process, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status), text("stdout"), text("stderr")};
  }
  Outcome run(const std::vector<std::string>& arguments) const { return finish(start(arguments)); }

  /// Waits until the condition holds or the program has ended. How long that takes on a busy machine is not known
  /// beforehand, so that no fixed time will do. False if neither has come about after two minutes.
  template <class Condition>
  bool wait_until(pid_t process, const Condition& holds) const {
    constexpr auto longest = std::chrono::seconds(120);
    const auto started = std::chrono::steady_clock::now();
    while (!holds() && !has_ended(process)) {
      if (std::chrono::steady_clock::now() > started + longest) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return true;
  }
  /// Waits until a run has written so many poses to its folder.
  void wait_for_poses(pid_t process, const std::string& folder, int count = 1) const {
    wait_until(process, [&] {
      int poses = 0;
      std::ifstream trajectory(path(folder + "/trajectory.txt"));
      for (std::string line; std::getline(trajectory, line);) poses += line.empty() || line.front() == '#' ? 0 : 1;
      return poses >= count;
    });
  }

 private:
  /// The process stays for finish() to collect.
  static bool has_ended(pid_t process) {
    siginfo_t info{};
    return waitid(P_PID, static_cast<id_t>(process), &info, WEXITED | WNOHANG | WNOWAIT) != 0 || info.si_pid != 0;
  }

  std::filesystem::path folder_;
};

}  // namespace holdfast::test
