// SPDX-License-Identifier: BSD-3-Clause
#include "active_run.hpp"

#include <algorithm>
#include <cmath>
#include <csignal>

#include "holdfast/bench/executor.hpp"
#include "holdfast/core/error.hpp"
#include "recorded_copies.hpp"
#include "run_folders.hpp"

namespace holdfast {

namespace fs = std::filesystem;

namespace {

Placeholders placeholders(const RecordedSequence& sequence, const fs::path& folder) {
  return {{"sequence", sequence.folder.string()},
          {"name", sequence.name},
          {"associations", (folder / "associations.txt").string()},
          {"settings", (folder / "settings.yaml").string()},
          {"output", folder.string()}};
}

/// Where a system left its trajectory, or where it runs: relative to its folder.
fs::path below(const fs::path& folder, const std::string& path) {
  return fs::path(path).is_absolute() ? fs::path(path) : folder / path;
}

RecordedSequence sequence_of(const RunPlan& plan, const PlannedRun& run, const fs::path& output) {
  if (!plan.variants[run.variant].is_external()) return {};
  return run.copy ? read_copy(plan.copies[*run.copy], output) : *plan.recordings[run.sequence];
}

}  // namespace

fs::path folder_of(const PlannedRun& run, const fs::path& output) { return output / "runs" / run.id; }

void remove_incomplete_runs(const fs::path& runs) {
  std::error_code error;
  std::vector<fs::path> found;
  for (fs::recursive_directory_iterator entry(runs, error), end; !error && entry != end; entry.increment(error)) {
    if (entry.depth() >= 2) entry.disable_recursion_pending();
    if (entry->path().filename().string().find(incomplete_mark) != std::string::npos) found.push_back(entry->path());
  }
  for (const fs::path& folder : found) fs::remove_all(folder, error);
}

ActiveRun::ActiveRun(const RunPlan& plan, const PlannedRun& run, const BenchOptions& options)
    : plan_(plan),
      run_(run),
      output_(options.output),
      grace_(options.grace),
      final_folder_(fs::absolute(folder_of(run, options.output))),
      folder_(incomplete_folder(final_folder_)),
      sequence_(sequence_of(plan, run, options.output)),
      process_(start(plan, run, sequence_, options, folder_)) {
  cost_.alone = true;
}

Process ActiveRun::start(const RunPlan& plan, const PlannedRun& run, const RecordedSequence& sequence,
                         const BenchOptions& options, const fs::path& folder) {
  std::error_code error;
  fs::remove_all(folder, error);
  fs::create_directories(folder, error);
  if (!fs::is_directory(folder, error)) throw InputError({folder.string()}, "the folder of a run cannot be made");
  ProcessRequest request;
  request.log = folder / log_file;
  const Variant& variant = plan.variants[run.variant];
  if (!variant.is_external()) {
    const fs::path configuration = folder / configuration_file;
    write_file_atomically(configuration, run.request);
    request.command = options.program;
    for (const std::string& word : {std::string("run"), configuration.string(), std::string("--output"),
                                    folder.string(), std::string("--overwrite"), std::string("--quiet")})
      request.command.push_back(word);
    return Process(request);
  }
  const ExternalSystem& system = plan.matrix.systems[*variant.system];
  write_file_atomically(folder / external_request_file, run.request);
  write_file_atomically(folder / "associations.txt", associations_text(sequence));
  write_file_atomically(folder / "settings.yaml", orb_slam2_settings(sequence, system.settings));
  const Placeholders values = placeholders(sequence, folder);
  for (const std::string& word : system.command) request.command.push_back(fill_placeholders(word, values));
  for (const auto& [name, value] : system.environment)
    request.environment.emplace_back(name, fill_placeholders(value, values));
  request.folder = below(folder, fill_placeholders(system.folder, values));
  return Process(request);
}

bool ActiveRun::poll() {
  if (const auto end = process_.poll()) {
    cost_.process = *end;
    take_load();
    return true;
  }
  const double over_time = process_.seconds() - run_.time_limit;
  if (over_time > 0.0 && !out_of_time_) {
    out_of_time_ = true;
    process_.terminate();
  } else if (over_time > grace_) {
    process_.kill();
  }
  return false;
}

bool ActiveRun::was_terminated() const {
  const int signal = cost_.process.signal;
  return !out_of_time_ && (signal == SIGTERM || signal == SIGINT || signal == SIGHUP || signal == SIGKILL);
}

void ActiveRun::take_load() {
  cost_.load_average = load_at_start_.load_average;
  const ProcessEnd& end = cost_.process;
  const double busy = machine_load().busy_seconds - load_at_start_.busy_seconds;
  // Both clocks tick in hundredths of a second, so that the difference of short runs can be negative.
  if (end.wall_seconds > 0.0)
    cost_.other_processors = std::max(0.0, busy - end.user_seconds - end.system_seconds) / end.wall_seconds;
  if (std::isnan(busy)) cost_.other_processors = busy;
}

void ActiveRun::judge_end() {
  const ProcessEnd& end = cost_.process;
  if (!end.was_started) {
    result_.status = RunStatus::not_started;
  } else if (out_of_time_) {
    result_.status = RunStatus::timed_out;
  } else if (end.signal != 0) {
    result_.status = RunStatus::crashed;
    result_.code = end.signal;
  } else {
    result_.status = end.exit_code == 0 ? RunStatus::finished : RunStatus::failed;
    result_.code = end.exit_code;
  }
}

void ActiveRun::evaluate_external() {
  const ExternalSystem& system = plan_.matrix.systems[*plan_.variants[run_.variant].system];
  const RecordedSequence& sequence = sequence_;
  const Placeholders values = placeholders(sequence, folder_);
  const fs::path working_folder = below(folder_, fill_placeholders(system.folder, values));
  const SalvagedTrajectory salvaged =
      salvage_trajectory(below(working_folder, fill_placeholders(system.trajectory, values)));
  result_.not_finite = salvaged.not_finite;
  result_.malformed = salvaged.malformed;
  std::vector<double> frames, poses;
  for (const ListedPair& pair : sequence.frames) frames.push_back(pair.colour.timestamp);
  for (const TimedPose& pose : salvaged.poses) poses.push_back(pose.timestamp);
  result_.frames = frames.size();
  result_.poses = measure_coverage(frames, poses).poses;
  if (salvaged.exists) write_trajectory(folder_ / "trajectory.txt", salvaged.poses);
  if (salvaged.poses.empty()) {
    result_.no_errors = salvaged.exists ? "no pose" : "no trajectory";
    return;
  }
  EvaluationOptions options;
  options.estimate_name = "trajectory.txt";
  options.truth_frame = sequence.truth.frame();
  try {
    const Trajectory truth = transformed(sequence.truth, read_trajectory(sequence.folder / "groundtruth.txt"));
    const Evaluation evaluation = evaluate(truth, salvaged.poses, options, frames);
    take_errors(evaluation, result_);
    write_file_atomically(folder_ / "evaluation.json", to_json(evaluation));
    write_file_atomically(folder_ / "tracks.json", to_tracks_json(evaluation));
  } catch (const InputError&) {
    throw;  // the truth cannot be read: no fault of the run
  } catch (const Error&) {
    result_.no_errors = "the poses cannot be compared with the truth";
  }
}

void ActiveRun::complete() {
  judge_end();
  if (plan_.variants[run_.variant].is_external())
    evaluate_external();
  else
    read_own_run(folder_, result_, cost_);
  cost_.machine = machine_name();
  // Here too, should the run have ended before it wrote its own.
  if (!plan_.variants[run_.variant].is_external()) write_file_atomically(folder_ / configuration_file, run_.request);
  write_file_atomically(folder_ / cost_file, to_json(cost_));
  write_file_atomically(folder_ / result_file, to_json(result_));
  std::error_code error;
  fs::remove_all(final_folder_, error);
  fs::rename(folder_, final_folder_, error);
  // The same run on another node, taken for lost, may have ended at the same time: one result is as good as the other.
  if (error && has_result(plan_, run_, output_)) {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
    return;
  }
  if (error) throw InputError({final_folder_.string()}, "the folder of a run cannot be named: " + error.message());
}

void ActiveRun::discard() {
  process_.kill();
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

}  // namespace holdfast
