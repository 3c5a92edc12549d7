// SPDX-License-Identifier: BSD-3-Clause
#include "recorded_copies.hpp"

#include <set>

#include "holdfast/bench/process.hpp"
#include "holdfast/core/error.hpp"
#include "run_folders.hpp"

namespace holdfast {

namespace fs = std::filesystem;

namespace {

constexpr const char* request_file = "copy.yaml";

fs::path copies_folder(const fs::path& output) { return output / "copies"; }

bool is_made(const RecordedCopy& copy, const fs::path& folder) {
  std::error_code ignored;
  return fs::exists(folder / request_file, ignored) && content_of(folder / request_file) == copy.configuration;
}

std::string end_of(const std::string& text) {
  constexpr std::size_t most = 1000;
  return text.size() <= most ? text : text.substr(text.size() - most);
}

/// Runs `holdfast record` to its end; false if it was stopped.
bool record(const fs::path& configuration, const fs::path& folder, const BenchOptions& options) {
  ProcessRequest request;
  request.log = folder / log_file;
  request.command = options.program;
  for (const std::string& word : {std::string("record"), configuration.string(), std::string("--output"),
                                  folder.string(), std::string("--overwrite"), std::string("--quiet")})
    request.command.push_back(word);
  Process process(request);
  std::optional<ProcessEnd> end;
  while (!(end = process.poll())) {
    if (options.stop()) {
      process.kill();
      return false;
    }
    wait_for_processes(0.1);
  }
  if (options.stop()) return false;  // the signal may have ended it
  if (!end->was_started || end->signal != 0 || end->exit_code != 0)
    throw InputError({folder.string()},
                     "the frames for external systems cannot be recorded:\n" + end_of(content_of(request.log)));
  return true;
}

/// Makes one copy; false if it was stopped.
bool make_copy(const RecordedCopy& copy, const BenchOptions& options) {
  const fs::path final_folder = folder_of(copy, options.output);
  if (is_made(copy, final_folder)) return true;
  const fs::path folder = incomplete_folder(final_folder);
  std::error_code error;
  fs::remove_all(folder, error);
  fs::create_directories(folder, error);
  if (!fs::is_directory(folder, error)) throw InputError({folder.string()}, "the folder of a copy cannot be made");
  // Its name marks the copy as complete, so that it gets it last.
  const fs::path configuration = folder / "source.yaml";
  write_file_atomically(configuration, copy.configuration);
  bool is_done = false;
  try {
    is_done = record(configuration, folder, options);
  } catch (...) {
    fs::remove_all(folder, error);
    throw;
  }
  if (!is_done) {
    fs::remove_all(folder, error);
    return false;
  }
  fs::rename(configuration, folder / request_file);
  if (!is_made(copy, final_folder)) fs::remove_all(final_folder, error);
  fs::rename(folder, final_folder, error);
  if (!error) return true;
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  if (is_made(copy, final_folder)) return true;  // another process made the same copy
  throw InputError({final_folder.string()}, "the folder of a copy cannot be named: " + error.message());
}

}  // namespace

fs::path folder_of(const RecordedCopy& copy, const fs::path& output) {
  return fs::absolute(copies_folder(output)) / copy.id;
}

bool make_copies(const RunPlan& plan, const std::vector<std::size_t>& runs, const BenchOptions& options) {
  std::set<std::size_t> needed;
  for (const std::size_t run : runs)
    if (plan.runs[run].copy) needed.insert(*plan.runs[run].copy);
  for (const std::size_t copy : needed)
    if (!make_copy(plan.copies[copy], options)) return false;
  return true;
}

void remove_copies(const fs::path& output) {
  std::error_code ignored;
  fs::remove_all(copies_folder(output), ignored);
}

RecordedSequence read_copy(const RecordedCopy& copy, const fs::path& output) {
  RecordedSequence sequence;
  sequence.name = copy.name;
  sequence.folder = folder_of(copy, output);
  const fs::path recording = sequence.folder / "recording.yaml";  // of `holdfast record`, with the camera of its frames
  std::vector<Diagnostic> diagnostics;
  const ConfigurationNode root = read_yaml(recording);
  const ConfigurationNode* camera = root.find("camera");
  if (camera == nullptr)
    throw InputError({recording.string()},
                     "has no camera, which external systems need; expected a source that knows its camera, or `camera` "
                     "of the sequence");
  if (const auto known = read_camera(*camera, diagnostics)) sequence.camera = *known;
  if (!diagnostics.empty()) throw ConfigurationError(diagnostics);
  sequence.frames = read_association_list(sequence.folder / "associations.txt");
  return sequence;
}

}  // namespace holdfast
