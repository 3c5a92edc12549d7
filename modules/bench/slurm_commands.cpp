// SPDX-License-Identifier: BSD-3-Clause
#include "slurm_commands.hpp"

#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <sstream>

#include "holdfast/bench/process.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast {

namespace fs = std::filesystem;

namespace {

constexpr double longest_answer = 60.0;  // of a command of Slurm [s]

struct Answer {
  bool is_good = false;
  std::string text;
};

Answer ask(const std::vector<std::string>& command, const fs::path& folder) {
  const fs::path file = folder / ("." + command.front() + "-" + std::to_string(getpid()));
  std::error_code ignored;
  fs::remove(file, ignored);
  Process process(ProcessRequest{command, {}, {}, file});
  std::optional<ProcessEnd> end;
  while (!(end = process.poll())) {
    if (process.seconds() > longest_answer) process.kill();
    wait_for_processes(0.1);
  }
  std::ifstream stream(file, std::ios::binary);
  Answer answer{end->was_started && end->signal == 0 && end->exit_code == 0,
                {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()}};
  fs::remove(file, ignored);
  if (!end->was_started)
    throw Error("the program '" + command.front() + "' is not found; is this a host from which jobs are submitted?");
  return answer;
}

}  // namespace

std::string slurm_job_name(const fs::path& output) {
  // FNV-1a of the path: jobs of other folders must not be taken for ours.
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char c : fs::weakly_canonical(output).string()) {
    hash ^= static_cast<unsigned char>(c);
    hash *= 0x100000001b3ULL;
  }
  char text[17];
  std::snprintf(text, sizeof(text), "%016llx", static_cast<unsigned long long>(hash));
  return std::string("holdfast-") + text;
}

std::string shell_quoted(const std::string& word) {
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string slurm_script(const std::vector<std::string>& run_command, const fs::path& list) {
  std::string text =
      "#!/bin/sh\n# A run of `holdfast bench`: the one in line SLURM_ARRAY_TASK_ID + 1 of the list.\n"
      "run=$(sed -n \"$((SLURM_ARRAY_TASK_ID + 1))p\" " +
      shell_quoted(list.string()) + ")\n[ -n \"$run\" ] || exit 1\nexec";
  for (const std::string& word : run_command) text += " " + shell_quoted(word);
  return text + " --run \"$run\"\n";
}

void submit_slurm(const SlurmOptions& options, const std::string& name, const fs::path& folder, std::size_t count,
                  bool alone) {
  std::vector<std::string> command = {"sbatch",
                                      "--parsable",
                                      "--requeue",
                                      "--open-mode=append",
                                      "--job-name=" + name,
                                      "--array=0-" + std::to_string(count - 1),
                                      "--output=" + (folder / "%a.log").string()};
  const auto add = [&](const char* option, const std::string& value) {
    if (!value.empty()) command.push_back(std::string("--") + option + "=" + value);
  };
  add("partition", options.partition);
  add("account", options.account);
  add("time", options.time);
  add("mem", options.memory);
  add("constraint", options.constraint);
  add("cpus-per-task", options.processors > 0 ? std::to_string(options.processors) : "");
  if (alone) command.emplace_back("--exclusive");
  command.push_back((folder / "job.sh").string());
  const Answer answer = ask(command, folder);
  if (!answer.is_good) throw Error("sbatch refused the jobs of the bench: " + answer.text);
}

std::vector<QueuedTask> parse_queue(const std::string& text, const std::string& name) {
  std::vector<QueuedTask> tasks;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = line.find('|'), second = line.find('|', first + 1);
    if (!line.starts_with(name + "-") || second == std::string::npos) continue;
    QueuedTask task;
    const std::string batch = line.substr(name.size() + 1, first - name.size() - 1);
    const std::string number = line.substr(first + 1, second - first - 1);
    char rest = 0;
    if (std::sscanf(batch.c_str(), "%zu%c", &task.batch, &rest) != 1 ||
        std::sscanf(number.c_str(), "%zu%c", &task.task, &rest) != 1)
      continue;
    task.state = line.substr(second + 1);
    tasks.push_back(std::move(task));
  }
  return tasks;
}

std::optional<std::vector<QueuedTask>> query_slurm(const std::string& name, const fs::path& folder) {
  const Answer answer = ask({"squeue", "--me", "--noheader", "--array", "--format=%j|%K|%T"}, folder);
  if (!answer.is_good) return std::nullopt;
  return parse_queue(answer.text, name);
}

void cancel_slurm(const std::string& name, const fs::path& folder, std::size_t batches) {
  for (std::size_t batch = 0; batch < batches; ++batch)
    ask({"scancel", "--quiet", "--name=" + name + "-" + std::to_string(batch)}, folder);
}

}  // namespace holdfast
