// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate_command.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>

#include "holdfast/core/error.hpp"
#include "holdfast/evaluation/evaluation.hpp"
#include "output_file.hpp"
#include "positive_number.hpp"
#include "terminal.hpp"
#include "usage_error.hpp"

namespace holdfast {

namespace {

struct EvaluateArguments {
  std::string truth;
  std::string estimate;
  std::string alignment = "se3";
  std::string format = "auto";
  std::string times;
  std::string write;
  std::string write_format = "tum";
  std::string frames;
  std::string json;
  std::string csv;
  std::string plots;
  bool overwrite = false;
  EvaluationOptions options;
};

constexpr const char* evaluate_explanation = R"(
Trajectories are in one of these formats, which --format auto recognises; '#' begins a comment:
  tum        timestamp tx ty tz qx qy qz qw, separated by blanks; seconds and metres
  kitti      12 numbers, the rows of T_world_camera; stamps from --times, else ten poses a second
  euroc      timestamp, tx, ty, tz, qw, qx, qy, qz, ..., with commas; nanoseconds and metres

Definitions
  pairing    stamps one-to-one, the nearest first, closer than --max-dt
  ATE        distance of paired positions after alignment
  RPE        relative error over --delta seconds as the TUM benchmark's tool computes it with a fixed
             delta (a pair that ends at the last pose is left out), and over --distance metres of
             true path
  coverage   poses with the stamp of a frame / colour-depth pairs of the sequence; missing frames
             count as missing; 'unknown' without --frames
  S.D.       standard deviation of the population

Examples
  holdfast evaluate groundtruth.txt trajectory.txt
  holdfast evaluate fr1_xyz/groundtruth.txt trajectory.txt --frames fr1_xyz --plots figures
  holdfast evaluate groundtruth.txt monocular.txt --alignment sim3 --json -
  holdfast evaluate poses/00.txt trajectory.txt --times sequences/00/times.txt
  holdfast evaluate data.csv trajectory.txt --write trajectory.csv --write-format euroc
)";

/// The names that `run` gives them, too.
constexpr const char* top_view_file = "trajectory.svg";
constexpr const char* error_over_time_file = "error.svg";

void write_plots(const std::filesystem::path& folder, const Evaluation& evaluation) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError({folder.string()}, "cannot be created: " + error.message());
  write_file_atomically(folder / top_view_file, top_view_svg(evaluation));
  write_file_atomically(folder / error_over_time_file, error_over_time_svg(evaluation));
}

/// Reads a trajectory, and says what of it does not count.
Trajectory read_with_notes(const std::string& file, const TrajectoryReading& reading) {
  TrajectoryFile read = read_trajectory_file(file, reading);
  if (read.format == TrajectoryFormat::kitti && reading.stamps.empty())
    print_warning(file + ": KITTI's format has no time stamps, and --times names none: ten poses a second are assumed");
  if (const std::string omissions = read.omissions(); !omissions.empty())
    print_warning(file + ": leaves out " + omissions);
  return std::move(read.poses);
}

void run(EvaluateArguments arguments) {
  arguments.truth = input_name(arguments.truth);
  arguments.estimate = input_name(arguments.estimate);
  if (arguments.truth == arguments.estimate && arguments.truth == input_name("-"))
    throw UsageError("only one trajectory can come from standard input; give the other one a file");
  if (arguments.json == "-" && arguments.csv == "-")
    throw UsageError("--json and --csv cannot both go to standard output; give one of them a file");
  const std::filesystem::path plots = arguments.plots;
  require_new_files({arguments.json, arguments.csv, arguments.write, plots.empty() ? plots : plots / top_view_file,
                     plots.empty() ? plots : plots / error_over_time_file},
                    arguments.overwrite);
  arguments.options.alignment = parse_alignment(arguments.alignment).value();
  arguments.options.truth_name = arguments.truth;
  arguments.options.estimate_name = arguments.estimate;
  TrajectoryReading reading;
  reading.format = find_trajectory_format(arguments.format);
  if (!arguments.times.empty()) reading.stamps = read_frame_stamps(arguments.times);
  const Trajectory truth = read_with_notes(arguments.truth, reading);
  const Trajectory estimate = read_with_notes(arguments.estimate, reading);
  std::optional<std::vector<double>> frames;
  if (!arguments.frames.empty()) frames = read_frame_stamps(arguments.frames);
  const Evaluation evaluation = evaluate(truth, estimate, arguments.options, frames);
  print_warnings(evaluation.warnings);
  if (arguments.json != "-" && arguments.csv != "-") {
    std::cout << printable(to_text(evaluation));
    if (!frames) std::cout << "Coverage needs --frames LIST.\n";
  }
  if (!arguments.json.empty()) write_output(arguments.json, to_json(evaluation));
  if (!arguments.write.empty())
    write_trajectory(arguments.write, estimate, find_trajectory_format(arguments.write_format).value());
  if (!arguments.csv.empty()) write_output(arguments.csv, to_csv(evaluation));
  if (!arguments.plots.empty()) write_plots(arguments.plots, evaluation);
}

}  // namespace

void add_evaluate_command(CLI::App& app, int& exit_code) {
  const auto arguments = std::make_shared<EvaluateArguments>();
  CLI::App* command =
      app.add_subcommand("evaluate", "Compare an estimated trajectory with the truth: ATE, RPE, coverage");
  command->footer(evaluate_explanation);
  command->add_option("TRUTH", arguments->truth, "True trajectory; '-': standard input")->required();
  command->add_option("ESTIMATE", arguments->estimate, "Estimated trajectory; '-': standard input")->required();
  command
      ->add_option("--alignment", arguments->alignment,
                   "se3: rotation and translation; sim3: also scale, for monocular runs; none: as they are")
      ->type_name("KIND")
      ->check(CLI::IsMember({"se3", "sim3", "none"}))
      ->capture_default_str();
  command->add_option("--format", arguments->format, "Format of both trajectories; auto recognises that of each")
      ->type_name("FORMAT")
      ->check(CLI::IsMember({"auto", "tum", "kitti", "euroc"}))
      ->capture_default_str();
  command->add_option("--times", arguments->times, "Time stamps of trajectories in KITTI's format, one a line [s]")
      ->type_name("FILE");
  command->add_option("--write", arguments->write, "Also write the estimate, in the format --write-format")
      ->type_name("FILE");
  command->add_option("--write-format", arguments->write_format, "Format of the file that --write names")
      ->type_name("FORMAT")
      ->check(CLI::IsMember({"tum", "kitti", "euroc"}))
      ->capture_default_str();
  command->add_option("--max-dt", arguments->options.max_time_difference, "Stamps of a pair are closer than this [s]")
      ->type_name("S")
      ->check(positive_number())
      ->capture_default_str();
  command->add_option("--delta", arguments->options.time_step, "Time step of the relative error [s]")
      ->type_name("S")
      ->check(positive_number())
      ->capture_default_str();
  command->add_option("--distance", arguments->options.path_step, "Step of true path of the relative error [m]")
      ->type_name("M")
      ->check(positive_number())
      ->capture_default_str();
  command
      ->add_option("--frames", arguments->frames,
                   "Frames of the sequence, for the coverage: a file whose lines begin with a stamp, or the folder of "
                   "a TUM sequence (its colour-depth pairs within 0.02 s)")
      ->type_name("LIST");
  command->add_option("--json", arguments->json, "Also write the figures as JSON; '-': to standard output, no table")
      ->type_name("FILE");
  command->add_option("--csv", arguments->csv, "Also write the figures as CSV; '-': to standard output, no table")
      ->type_name("FILE");
  command->add_option("--plots", arguments->plots, "Write trajectory.svg and error.svg into this folder")
      ->type_name("DIR");
  add_overwrite_option(*command, arguments->overwrite);
  command->callback([arguments, &exit_code] {
    run(*arguments);
    exit_code = 0;
  });
}

}  // namespace holdfast
