// SPDX-License-Identifier: BSD-3-Clause
#include "run_command.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <opencv2/core/utility.hpp>
#include <optional>
#include <string>
#include <vector>

#include "configured_command.hpp"
#include "free_memory.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/evaluation/number_text.hpp"
#include "holdfast/run/results.hpp"
#include "holdfast/run/run.hpp"
#include "holdfast/run/trajectory_journal.hpp"
#include "output_folder.hpp"
#include "program_host.hpp"
#include "recorder.hpp"
#include "server_addresses.hpp"
#include "terminal.hpp"
#include "usage_error.hpp"
#include "viewing.hpp"

namespace holdfast {

namespace {

constexpr int low_coverage_exit_code = 3;
constexpr double free_memory_period = 30.0;  // [s] between the times at which what is free goes back to the system

struct RunArguments : ConfiguredArguments {
  std::filesystem::path map, record;
  bool localise = false, strict = false, view = false;
};

/// Results would take the place of the map that the run begins with.
void keep_map_out_of_results(const RunArguments& arguments) {
  std::error_code ignored;
  if (arguments.map.empty() || !std::filesystem::exists(arguments.map, ignored)) return;
  if (std::filesystem::equivalent(std::filesystem::absolute(arguments.map).parent_path(), arguments.output, ignored))
    throw InputError({arguments.map.string()},
                     "lies in the output folder, where this run's results would replace it; choose another --output");
}

void keep_recording_out_of_results(const RunArguments& arguments) {
  if (arguments.record.empty()) return;
  const auto canonical = [](const std::filesystem::path& folder) {  // with a slash at the end, or none, the same
    return std::filesystem::weakly_canonical(std::filesystem::absolute(folder / "")).parent_path();
  };
  if (canonical(arguments.record) == canonical(arguments.output))
    throw UsageError("--record and --output name the same folder; give the recording one of its own");
}

/// What lives as long as the frames are read.
struct Running {
  std::optional<FolderLock> lock;
  std::optional<Progress> progress;
  std::optional<TrajectoryJournal> journal;
  std::optional<Recorder> recorder;
  Trajectory truth;                              ///< of what is recorded
  std::vector<std::shared_ptr<Viewer>> viewers;  ///< kept, so that they outlive the pipeline
  Stopwatch since_memory_returned;
  std::size_t warnings_printed = 0;  ///< of RunRecord::warnings, which begin with those of the configuration
};

/// Takes the folder; a run that was killed there is named, so that nobody takes its results for whole ones.
FolderLock prepare_folder(const RunArguments& arguments) {
  try {
    return prepare_output_folder(arguments.output, arguments.overwrite, result_names());
  } catch (const OutputFolderNotEmpty&) {
    const int poses = poses_of_killed_run(arguments.output);
    if (poses < 0) throw;
    throw InputError({arguments.output.string()},
                     "the output folder holds a run that was killed, with " +
                         counted(static_cast<std::size_t>(poses), "pose") +
                         " in trajectory.txt; name another one, or add --overwrite to replace it");
  }
}

/// Prints what is new since the last call, but for what is printed as an error.
void print_new_warnings(const Warnings& warnings, Running& running, const std::string& error = {}) {
  for (; running.warnings_printed < warnings.size(); ++running.warnings_printed)
    if (const std::string text = warnings[running.warnings_printed].to_string(); text != error) print_warning(text);
}

/// Shows the progress of a run, prepares its folder, keeps its poses as they come and asks for its end after a signal.
RunOptions options_of(const RunArguments& arguments, const Registry& registry, const Configuration& configuration,
                      const Stopwatch& since_start, Running& running) {
  RunOptions options;
  if (!arguments.record.empty())
    options.wrap_source = [&](std::unique_ptr<FrameSource> source) {
      running.recorder.emplace(configuration, registry, source->describe(), arguments.record, arguments.overwrite);
      running.truth = source->truth();
      return recorded_source(std::move(source), *running.recorder);
    };
  options.pipeline = {
      .output_directory = arguments.output, .map_file = arguments.map, .localise_only = arguments.localise};
  options.since_start = since_start;
  options.stop = interrupted;
  options.on_start = [&](const RunRecord& record) {
    running.lock.emplace(prepare_folder(arguments));
    write_file_atomically(arguments.output / "config.yaml", to_yaml(record.configuration));
    running.journal.emplace(arguments.output);
    running.viewers = running_viewers_of_program();
    print_server_addresses();
    print_new_warnings(record.warnings, running);
    running.progress.emplace(record.source.frame_count, arguments.quiet);
  };
  options.on_frame = [&](const RunProgress& run) {
    if (run.result.T_world_camera) running.journal->add({run.result.timestamp, *run.result.T_world_camera});
    running.progress->update(run.frames_done, to_string(run.result.status));
    if (running.since_memory_returned.seconds() < free_memory_period) return;
    return_free_memory();
    running.since_memory_returned = {};
  };
  return options;
}

int print_end(const RunArguments& arguments, const RunRecord& record) {
  if (!arguments.quiet && record.summary.frames() > 0)
    std::fputs(bold_labels(printable(summary_text(record)), STDOUT_FILENO).c_str(), stdout);
  const std::string warning = coverage_warning(record);
  if (!record.failure.empty())
    print_error(record.failure);
  else if (record.was_interrupted)
    std::fprintf(stderr, "interrupted; what was done is in %s\n", printable(arguments.output.string()).c_str());
  else if (record.trajectory.empty())
    print_error("no frame got a pose" +
                (warning.empty() ? std::string("; is there depth, and enough to see?") : ": " + warning));
  else if (const std::string unsupported = unsupported_poses(record); !unsupported.empty())
    print_error(unsupported);
  else if (arguments.strict && !warning.empty())
    print_error(warning);
  else if (!warning.empty())
    print_warning(warning);
  if (record.was_interrupted) return interrupted_exit_code();
  if (!record.failure.empty() || record.trajectory.empty() || !unsupported_poses(record).empty()) return 1;
  return arguments.strict && !warning.empty() ? low_coverage_exit_code : 0;
}

/// The last line: where to look.
void print_report(const RunArguments& arguments) {
  if (!arguments.quiet)
    std::printf("%s               %s\n", bold("report", STDOUT_FILENO).c_str(),
                printable((arguments.output / "report.html").string()).c_str());
}

int run_configuration(const RunArguments& arguments, const ProgramHost& host) {
  const Stopwatch since_start;
  cv::setNumThreads(1);  // OpenCV's own threads would change neither result nor, at this size, time for the better
  catch_interrupts();
  keep_map_out_of_results(arguments);
  keep_recording_out_of_results(arguments);
  Registry registry = host.modules();
  Configuration configuration = load_configuration(arguments.configuration, arguments.overrides, registry);
  if (arguments.view) add_viewer(configuration, registry);
  Running running;
  print_new_warnings(configuration.warnings, running);
  const RunRecord record =
      run(configuration, registry, options_of(arguments, registry, configuration, since_start, running));
  running.progress.reset();
  running.journal.reset();
  print_new_warnings(record.warnings, running, unsupported_poses(record));
  try {
    write_results(record, arguments.output);
  } catch (const InputError&) {
    print_end(arguments, record);  // the summary may be all that is left of it
    throw;
  }
  const int exit_code = print_end(arguments, record);
  print_report(arguments);
  if (running.recorder) {
    running.recorder->finish(running.truth);
    if (const std::string losses = running.recorder->losses(); !losses.empty()) print_warning(losses);
  }
  if (arguments.view) show_until_stopped(running.viewers, record);
  return exit_code;
}

}  // namespace

void add_run_command(CLI::App& app, int& exit_code, const ProgramHost& host) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* command = app.add_subcommand("run", "Track a camera through a recording or a simulation");
  command->footer(
      "\nWrites into the output folder:\n"
      "  trajectory.txt  every frame with a pose, TUM format      keyframes.txt  those of the map\n"
      "  report.html     summary, plots and stage times           run.json       the same for programs\n"
      "  config.yaml     the configuration with every default     evaluation.json, *.svg  where there is truth\n"
      "  map.hfm         the map, for --map and `holdfast map`    static_map.ply  its points, or with\n"
      "                                                           dense_map.enabled a dense cloud\n"
      "  surface.ply     the mesh of the room, with surface.enabled; with surface.navigation map.pgm, map.yaml,\n"
      "                  octomap.bt and octomap.ot, too\n"
      "While it runs, trajectory.txt holds the poses so far; of a run that is killed they are what is left.\n"
      "Exits 0 when the run reached its end with a trajectory that its map supports, 3 with --strict when fewer\n"
      "frames than run.minimum_coverage have a pose, 130 on Ctrl-C, 143 on SIGTERM and SIGHUP (what was done is "
      "kept),\n"
      "2 when the configuration is wrong, 1 for anything else.\n\n"
      "Examples\n"
      "  holdfast run demo --output out/demo\n"
      "  holdfast run full --set source.tum.path=rgbd_dataset_freiburg3_walking_xyz --set camera=auto --output "
      "out/xyz\n"
      "  holdfast run rgbd --set source.tum.path=rgbd_dataset_freiburg1_xyz --output out/empty   nobody there: no "
      "masks\n"
      "  holdfast run rgbd.yaml --set features.opencv_orb.count=1500 --set run.seed=2 --output out/swap\n"
      "  holdfast run demo --output out/demo --view          watch it in a browser\n"
      "  holdfast run rgbd.yaml --map out/xyz/map.hfm --output out/more              continue that map\n"
      "  holdfast run rgbd.yaml --map out/xyz/map.hfm --localise --output out/where  find the camera in it");
  add_configured_options(*command, *arguments);
  CLI::Option* map =
      command->add_option("--map", arguments->map, "A map.hfm of an earlier run, to continue; the file stays as it is");
  command->add_flag("--localise", arguments->localise, "Only find the camera in the map, and leave the map as it is")
      ->needs(map);
  command->add_flag("--strict", arguments->strict,
                    "Exit with 3 when the share of frames with a pose is below run.minimum_coverage");
  command->add_option("--record", arguments->record,
                      "Also record the frames in this folder, in TUM layout; the run uses them as they are recorded");
  command->add_flag("--view", arguments->view,
                    "Show the run in a browser while it goes, and its result until Ctrl-C (observer 'viewer')");
  command->callback([arguments, host, &exit_code] { exit_code = run_configuration(*arguments, host); });
}

}  // namespace holdfast
