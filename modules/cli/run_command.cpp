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

#include "configured_command.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/run/results.hpp"
#include "holdfast/run/run.hpp"
#include "output_folder.hpp"
#include "terminal.hpp"

namespace holdfast {

namespace {

struct Arguments : ConfiguredArguments {
  std::filesystem::path map;
  bool localise = false;
};

/// Results would take the place of the map that the run begins with.
void keep_map_out_of_results(const Arguments& arguments) {
  std::error_code ignored;
  if (arguments.map.empty() || !std::filesystem::exists(arguments.map, ignored)) return;
  if (std::filesystem::equivalent(std::filesystem::absolute(arguments.map).parent_path(), arguments.output, ignored))
    throw InputError({arguments.map.string()},
                     "lies in the output folder, where this run's results would replace it; choose another --output");
}

/// Shows the progress of a run, prepares its folder and asks for its end after Ctrl-C.
RunOptions options_of(const Arguments& arguments, const Stopwatch& since_start, std::optional<Progress>& progress,
                      std::optional<FolderLock>& lock) {
  RunOptions options;
  options.pipeline = {
      .output_directory = arguments.output, .map_file = arguments.map, .localise_only = arguments.localise};
  options.since_start = since_start;
  options.stop = interrupted;
  options.on_start = [&](const RunRecord& record) {
    lock.emplace(prepare_output_folder(arguments.output, arguments.overwrite, result_names()));
    write_file_atomically(arguments.output / "config.yaml", to_yaml(record.configuration));
    progress.emplace(record.source.frame_count, arguments.quiet);
  };
  options.on_frame = [&](const RunProgress& run) { progress->update(run.frames_done, to_string(run.result.status)); };
  return options;
}

int print_end(const Arguments& arguments, const RunRecord& record) {
  if (!arguments.quiet && record.summary.frames() > 0) std::fputs(printable(summary_text(record)).c_str(), stdout);
  if (!record.failure.empty())
    std::fprintf(stderr, "%s %s\n", red("error:", STDERR_FILENO).c_str(), printable(record.failure).c_str());
  else if (record.was_interrupted)
    std::fprintf(stderr, "interrupted; what was done is in %s\n", printable(arguments.output.string()).c_str());
  else if (record.trajectory.empty())
    std::fprintf(stderr, "%s no frame got a pose; is there depth, and enough to see?\n",
                 red("error:", STDERR_FILENO).c_str());
  if (record.was_interrupted) return interrupted_exit_code;
  return record.failure.empty() && !record.trajectory.empty() ? 0 : 1;
}

int run_configuration(const Arguments& arguments) {
  const Stopwatch since_start;
  cv::setNumThreads(1);  // OpenCV's own threads would change neither result nor, at this size, time for the better
  catch_interrupts();
  keep_map_out_of_results(arguments);
  Registry registry;
  register_builtin_plugins(registry);
  const Configuration configuration = load_configuration(arguments.configuration, arguments.overrides, registry);
  std::optional<FolderLock> lock;
  print_warnings(configuration.warnings);
  std::optional<Progress> progress;
  const RunRecord record = run(configuration, registry, options_of(arguments, since_start, progress, lock));
  progress.reset();
  try {
    write_results(record, arguments.output);
  } catch (const InputError&) {
    print_end(arguments, record);  // the summary may be all that is left of it
    throw;
  }
  return print_end(arguments, record);
}

}  // namespace

void add_run_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("run", "Track a camera through a recording or a simulation");
  command->footer(
      "\nWrites into the output folder:\n"
      "  trajectory.txt  every frame with a pose, TUM format      keyframes.txt  those of the map\n"
      "  report.html     summary, plots and stage times           run.json       the same for programs\n"
      "  config.yaml     the configuration with every default     evaluation.json, *.svg  where there is truth\n"
      "  map.hfm         the map, for --map and `holdfast map`    static_map.ply  its points, or with\n"
      "                                                           dense_map.enabled a dense cloud\n"
      "Exits 0 when the run reached its end with a trajectory, 130 on Ctrl-C (what was done is kept), 2 when the\n"
      "configuration is wrong, 1 for anything else.\n\n"
      "Examples\n"
      "  holdfast run examples/configs/demo.yaml --output out/demo\n"
      "  holdfast run examples/configs/rgbd.yaml --set source.tum.path=rgbd_dataset_freiburg1_xyz --output out/xyz\n"
      "  holdfast run rgbd.yaml --set features.opencv_orb.count=1500 --set run.seed=2 --output out/swap\n"
      "  holdfast run rgbd.yaml --map out/xyz/map.hfm --output out/more              continue that map\n"
      "  holdfast run rgbd.yaml --map out/xyz/map.hfm --localise --output out/where  find the camera in it");
  add_configured_options(*command, *arguments);
  CLI::Option* map =
      command->add_option("--map", arguments->map, "A map.hfm of an earlier run, to continue; the file stays as it is");
  command->add_flag("--localise", arguments->localise, "Only find the camera in the map, and leave the map as it is")
      ->needs(map);
  command->callback([arguments, &exit_code] { exit_code = run_configuration(*arguments); });
}

}  // namespace holdfast
