// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/bench/run_scheduler.hpp"

namespace holdfast {

/// A task of ours that Slurm has not ended yet.
struct QueuedTask {
  std::size_t batch = 0;
  std::size_t task = 0;
  std::string state;  ///< PENDING, RUNNING, COMPLETING, ...
};

/// The name of all jobs of a benchmark, without the number of their batch: the same for the same folder, another one
/// for another folder.
std::string slurm_job_name(const std::filesystem::path& output);
/// The script of a job array: task N executes the run in line N + 1 of the list.
std::string slurm_script(const std::vector<std::string>& run_command, const std::filesystem::path& list);
/// Words of a shell command.
std::string shell_quoted(const std::string& word);

/// Submits folder/job.sh as an array. Throws Error with what sbatch said.
void submit_slurm(const SlurmOptions& options, const std::string& name, const std::filesystem::path& folder,
                  std::size_t count, bool alone);
/// The tasks of all our batches; nothing while the controller does not answer. `folder` is for squeue's output. Throws
/// Error if this host has no Slurm.
std::optional<std::vector<QueuedTask>> query_slurm(const std::string& name, const std::filesystem::path& folder);
/// Reads lines "name|task|state" of squeue; those of other jobs are left out.
std::vector<QueuedTask> parse_queue(const std::string& text, const std::string& name);
/// Cancels all batches; says nothing of those that have ended.
void cancel_slurm(const std::string& name, const std::filesystem::path& folder, std::size_t batches);

}  // namespace holdfast
