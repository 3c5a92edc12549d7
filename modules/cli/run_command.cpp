// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/cli/run_command.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <opencv2/core/utility.hpp>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/cli/configured_command.hpp"
#include "holdfast/cli/frame_loop.hpp"
#include "holdfast/cli/output_folder.hpp"
#include "holdfast/cli/run_results.hpp"
#include "holdfast/cli/terminal.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/dense_map/static_scene.hpp"
#include "holdfast/map_io/map_export.hpp"
#include "holdfast/map_io/map_file.hpp"
#include "holdfast/pipeline/pipeline_builder.hpp"
#include "holdfast/plugin/builtin.hpp"

namespace holdfast {

namespace {

struct Arguments : ConfiguredArguments {
  std::filesystem::path map;
  bool localise = false;
};

std::size_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

/// A run that ended before its time has frames whose stamps nobody saw; they count as missing, in a gap at the end.
void count_frames_that_never_came(const RunRecord& record, Coverage& coverage) {
  if (record.frame_stamps.size() >= record.frames_expected) return;
  const std::size_t missing = record.frames_expected - record.frame_stamps.size();
  const double last = record.frame_stamps.back();
  coverage.frames += missing;
  const bool gap_is_open = !coverage.gaps.empty() && coverage.gaps.back().end == last &&
                           (record.trajectory.empty() || record.trajectory.back().timestamp < last);
  if (!gap_is_open) coverage.gaps.push_back({last, last, 0});
  coverage.gaps.back().frames += missing;
}

void evaluate_run(const FrameSource& source, RunRecord& record) {
  const Trajectory truth = source.truth();
  if (truth.empty()) {
    record.no_evaluation = "the source has no truth";
    return;
  }
  for (const SkippedFrame& skipped : record.skipped) record.frame_stamps.push_back(skipped.timestamp);
  std::sort(record.frame_stamps.begin(), record.frame_stamps.end());
  EvaluationOptions options;
  options.truth_name = "truth";
  options.estimate_name = "trajectory.txt";
  try {
    record.evaluation = evaluate(truth, record.trajectory, options, record.frame_stamps);
  } catch (const Error& error) {
    record.no_evaluation = error.what();
    return;
  }
  if (record.evaluation->coverage) count_frames_that_never_came(record, *record.evaluation->coverage);
}

/// Results would take the place of the map that the run begins with.
void keep_map_out_of_results(const Arguments& arguments) {
  std::error_code ignored;
  if (arguments.map.empty() || !std::filesystem::exists(arguments.map, ignored)) return;
  if (std::filesystem::equivalent(std::filesystem::absolute(arguments.map).parent_path(), arguments.output, ignored))
    throw InputError({arguments.map.string()},
                     "lies in the output folder, where this run's results would replace it; choose another --output");
}

void run(const Arguments& arguments, int& exit_code) {
  const Stopwatch since_start;
  cv::setNumThreads(1);  // OpenCV's own threads would change neither result nor, at this size, time for the better
  catch_interrupts();
  keep_map_out_of_results(arguments);

  Registry registry;
  register_builtin_plugins(registry);
  const Configuration configuration =
      load_configuration(arguments.configuration, arguments.overrides, registry, pipeline_sections());
  BuiltPipeline built = build_pipeline(
      configuration, registry,
      {.output_directory = arguments.output, .map_file = arguments.map, .localise_only = arguments.localise});
  prepare_output_folder(
      arguments.output, arguments.overwrite,
      {"report.html", "run.json", "trajectory.txt", "keyframes.txt", "evaluation.json", "tracks.json", "trajectory.svg",
       "error.svg", "config.yaml", "map.hfm", "static_map.ply", "objects.csv", "overlay"});
  write_file_atomically(arguments.output / "config.yaml", to_yaml(configuration));

  RunRecord record;
  record.configuration = &configuration;
  record.source = built.source->describe();
  record.camera = built.pipeline.camera();
  feed_frames(built, arguments.quiet, since_start, record);

  record.skipped = built.source->skipped();
  record.frames_expected = record.source.frame_count ? static_cast<std::size_t>(*record.source.frame_count)
                                                     : record.frame_stamps.size() + record.skipped.size();
  record.trajectory = built.pipeline.trajectory();
  record.keyframes = built.pipeline.keyframe_trajectory();
  record.map_keyframes = built.pipeline.map().keyframes().size();
  record.map_points = built.pipeline.map().points().size();
  record.mapping = built.pipeline.mapping_counts();
  record.loops = built.pipeline.loop_record();
  record.mask_ages = built.pipeline.mask_latencies();
  evaluate_run(*built.source, record);
  record.total_seconds = since_start.seconds();
  record.peak_memory = peak_memory();
  write_run_results(arguments.output, record);
  // A map that was only localised in has not changed.
  if (!arguments.localise && !built.pipeline.map().keyframes().empty()) {
    write_map(arguments.output / "map.hfm", built.pipeline.map());
    if (const StaticScene* scene = built.pipeline.static_scene())
      write_cloud_ply(arguments.output / "static_map.ply", scene->cloud(built.pipeline.map()));
    else
      write_points_ply(arguments.output / "static_map.ply", built.pipeline.map());
  }

  if (!arguments.quiet && record.summary.frames() > 0) std::fputs(run_summary_text(record).c_str(), stdout);
  if (!record.failure.empty())
    std::fprintf(stderr, "%s %s\n", red("error:", STDERR_FILENO).c_str(), record.failure.c_str());
  else if (record.was_interrupted)
    std::fprintf(stderr, "interrupted; what was done is in %s\n", arguments.output.c_str());
  else if (record.trajectory.empty())
    std::fprintf(stderr, "%s no frame got a pose; is there depth, and enough to see?\n",
                 red("error:", STDERR_FILENO).c_str());
  exit_code = record.was_interrupted                                 ? interrupted_exit_code
              : record.failure.empty() && !record.trajectory.empty() ? 0
                                                                     : 1;
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
  command->callback([arguments, &exit_code] { run(*arguments, exit_code); });
}

}  // namespace holdfast
