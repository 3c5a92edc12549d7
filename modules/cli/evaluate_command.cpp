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
#include "terminal.hpp"

namespace holdfast {

namespace {

struct EvaluateArguments {
  std::string truth;
  std::string estimate;
  std::string alignment = "se3";
  std::string frames;
  std::string json;
  std::string csv;
  std::string plots;
  EvaluationOptions options;
};

constexpr const char* explanation = R"(
Trajectories are in TUM format: one line 'timestamp tx ty tz qx qy qz qw' per pose, seconds and
metres, '#' begins a comment.

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
)";

void write_to(const std::string& target, const std::string& content) {
  if (target == "-")
    std::cout << content;
  else
    write_file_atomically(target, content);
}

void write_plots(const std::filesystem::path& folder, const Evaluation& evaluation) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError({folder.string()}, "cannot be created: " + error.message());
  write_file_atomically(folder / "top_view.svg", top_view_svg(evaluation));
  write_file_atomically(folder / "error_over_time.svg", error_over_time_svg(evaluation));
}

/// Reads a trajectory, and says what of it does not count.
Trajectory read_with_notes(const std::string& file) {
  TrajectoryFile read = read_trajectory_file(file);
  if (const std::string omissions = read.omissions(); !omissions.empty())
    std::cerr << "holdfast evaluate: " << printable(file) << ": leaves out " << omissions << '\n';
  return std::move(read.poses);
}

void run(EvaluateArguments arguments) {
  if (arguments.json == "-" && arguments.csv == "-")
    throw Error("--json and --csv cannot both go to standard output; give one of them a file");
  arguments.options.alignment = parse_alignment(arguments.alignment).value();
  arguments.options.truth_name = arguments.truth;
  arguments.options.estimate_name = arguments.estimate;
  const Trajectory truth = read_with_notes(arguments.truth);
  const Trajectory estimate = read_with_notes(arguments.estimate);
  std::optional<std::vector<double>> frames;
  if (!arguments.frames.empty()) frames = read_frame_stamps(arguments.frames);
  const Evaluation evaluation = evaluate(truth, estimate, arguments.options, frames);
  if (arguments.json != "-" && arguments.csv != "-") {
    std::cout << printable(to_text(evaluation));
    if (!frames) std::cout << "Coverage needs --frames LIST.\n";
  }
  if (!arguments.json.empty()) write_to(arguments.json, to_json(evaluation));
  if (!arguments.csv.empty()) write_to(arguments.csv, to_csv(evaluation));
  if (!arguments.plots.empty()) write_plots(arguments.plots, evaluation);
  std::cout.flush();
  if (!std::cout) throw Error("standard output could not be written");
}

}  // namespace

void add_evaluate_command(CLI::App& app, int& exit_code) {
  const auto arguments = std::make_shared<EvaluateArguments>();
  CLI::App* command =
      app.add_subcommand("evaluate", "Compare an estimated trajectory with the truth: ATE, RPE, coverage");
  command->footer(explanation);
  command->add_option("TRUTH", arguments->truth, "True trajectory, TUM format")->required();
  command->add_option("ESTIMATE", arguments->estimate, "Estimated trajectory, TUM format")->required();
  command
      ->add_option("--alignment", arguments->alignment,
                   "se3: rotation and translation; sim3: also scale, for monocular runs; none: as they are")
      ->type_name("KIND")
      ->check(CLI::IsMember({"se3", "sim3", "none"}))
      ->capture_default_str();
  command->add_option("--max-dt", arguments->options.max_time_difference, "Stamps of a pair are closer than this [s]")
      ->type_name("S")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--delta", arguments->options.time_step, "Time step of the relative error [s]")
      ->type_name("S")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--distance", arguments->options.path_step, "Step of true path of the relative error [m]")
      ->type_name("M")
      ->check(CLI::PositiveNumber)
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
  command->add_option("--plots", arguments->plots, "Write top_view.svg and error_over_time.svg into this folder")
      ->type_name("DIR");
  command->callback([arguments, &exit_code] {
    try {
      run(*arguments);
      exit_code = 0;
    } catch (const Error& error) {
      std::cerr << "holdfast evaluate: " << printable(error.what()) << '\n';
      exit_code = 1;
    }
  });
}

}  // namespace holdfast
