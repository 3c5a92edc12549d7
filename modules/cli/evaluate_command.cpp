// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate_command.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "evaluation_table.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/parsed_number.hpp"
#include "holdfast/evaluation/evaluation.hpp"
#include "holdfast/evaluation/number_text.hpp"
#include "holdfast/evaluation/time_offset.hpp"
#include "holdfast/run/trajectory_journal.hpp"
#include "output_file.hpp"
#include "positive_number.hpp"
#include "terminal.hpp"
#include "trajectory_correction.hpp"
#include "usage_error.hpp"

namespace holdfast {

namespace {

struct EvaluateArguments {
  std::string truth;
  std::vector<std::string> estimates;
  std::string time_offset = "0";
  std::string inverted;
  std::string mirrored, mirrored_estimate;
  std::string truth_unit = "m";
  std::string estimate_unit = "m";
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
  clocks     --time-offset is added to the stamps of the estimate; 'estimate' finds it within 5 s, by the
             least ATE with scale, with positions interpolated between poses
  coverage   poses with the stamp of a frame / colour-depth pairs of the sequence; missing frames
             count as missing; 'unknown' without --frames
  S.D.       standard deviation of the population
Warnings name what makes the figures meaningless whatever the estimate is: stamps that are not seconds, a clock
that is late, millimetres, inverted or mirrored poses, a truth of another body. Several estimates give a table
with one row each; the exit code is 1 if one of them cannot be compared.

Examples
  holdfast evaluate groundtruth.txt trajectory.txt
  holdfast evaluate fr1_xyz/groundtruth.txt trajectory.txt --frames fr1_xyz --plots figures
  holdfast evaluate groundtruth.txt monocular.txt --alignment sim3 --json -
  holdfast evaluate poses/00.txt trajectory.txt --times sequences/00/times.txt
  holdfast evaluate groundtruth.txt out/*/trajectory.txt --csv figures.csv
  holdfast evaluate groundtruth.txt trajectory.txt --time-offset estimate --truth-unit mm --invert truth
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

/// The journal of a run that was killed, or goes on, looks like the trajectory of a whole one.
void warn_of_journal(const std::string& file, const Trajectory& poses) {
  if (is_trajectory_journal(file))
    print_warning(file + ": is of a run that has not come to its end: " + counted(poses.size(), "pose") +
                  " as they were estimated, without later corrections; the figures are of this part");
}

double metres_of(const std::string& unit) { return unit == "mm" ? 1e-3 : unit == "cm" ? 1e-2 : 1.0; }

/// "x" to "z" as 0 to 2.
std::optional<int> axis_of(const std::string& name) {
  return name.empty() ? std::nullopt : std::optional<int>(name.front() - 'x');
}

TrajectoryCorrection correction_of_truth(const EvaluateArguments& arguments) {
  return {.is_inverted = arguments.inverted == "truth" || arguments.inverted == "both",
          .metres_per_unit = metres_of(arguments.truth_unit),
          .mirrored_axis = axis_of(arguments.mirrored)};
}

TrajectoryCorrection correction_of_estimate(const EvaluateArguments& arguments) {
  return {.is_inverted = arguments.inverted == "estimate" || arguments.inverted == "both",
          .metres_per_unit = metres_of(arguments.estimate_unit),
          .mirrored_axis = axis_of(arguments.mirrored_estimate)};
}

/// The offset that the user gives, or that fits best.
double time_offset(const EvaluateArguments& arguments, const std::string& name, const Trajectory& truth,
                   const Trajectory& estimate) {
  if (arguments.time_offset != "estimate") return std::stod(arguments.time_offset);
  constexpr double range = 5.0;
  const std::optional<TimeOffset> found = estimate_time_offset(truth, estimate, range);
  if (!found)
    throw Error(
        "no time offset of " + name +
        " can be estimated: fewer than 20 of its poses lie between true ones that move; if the clocks differ by "
        "more than a second, give the difference to --time-offset in seconds");
  if (found->at_limit)
    print_warning(name + ": the best time offset, " + fixed_text(found->offset, 3) +
                  " s, lies at the end of those compared; the true one may be larger: give one near it in seconds");
  return found->offset;
}

/// All that the estimates are compared with.
struct Reference {
  Trajectory truth;
  TrajectoryReading reading;
  std::optional<std::vector<double>> frames;
};

ComparedEstimate compare(const EvaluateArguments& arguments, const Reference& reference, const std::string& file) {
  ComparedEstimate compared{.name = file, .evaluation = {}, .failure = {}};
  const TrajectoryCorrection correction = correction_of_estimate(arguments);
  Trajectory estimate = read_with_notes(file, reference.reading);
  warn_of_journal(file, estimate);
  estimate = corrected(correction, std::move(estimate));
  EvaluationOptions options = arguments.options;
  options.estimate_name = file + (correction.text().empty() ? "" : " (" + correction.text() + ")");
  options.time_offset = time_offset(arguments, file, reference.truth, estimate);
  compared.evaluation = evaluate(reference.truth, estimate, options, reference.frames);
  if (!arguments.write.empty())
    write_trajectory(arguments.write, estimate, find_trajectory_format(arguments.write_format).value());
  return compared;
}

/// The same where others follow: the failure of one does not take the figures of the others.
ComparedEstimate compare_one_of_several(const EvaluateArguments& arguments, const Reference& reference,
                                        const std::string& file) {
  try {
    return compare(arguments, reference, file);
  } catch (const Error& error) {
    print_error(error.what());
    return {.name = file, .evaluation = {}, .failure = error.what()};
  }
}

void print_suspicions(const ComparedEstimate& estimate, bool names_it) {
  if (!estimate.evaluation) return;
  for (const Diagnostic& warning : estimate.evaluation->warnings)
    print_warning((names_it ? estimate.name + ": " : "") + warning.to_string());
}

/// Throws UsageError for options that exclude each other.
void check_usage(const EvaluateArguments& arguments) {
  const auto from_input =
      static_cast<std::size_t>(std::count(arguments.estimates.begin(), arguments.estimates.end(), input_name("-")));
  if (from_input + (arguments.truth == input_name("-") ? 1 : 0) > 1)
    throw UsageError("only one trajectory can come from standard input; give the other one a file");
  if (arguments.json == "-" && arguments.csv == "-")
    throw UsageError("--json and --csv cannot both go to standard output; give one of them a file");
  if (arguments.estimates.size() > 1 && !(arguments.plots.empty() && arguments.write.empty()))
    throw UsageError("--plots and --write are of one estimate; give one at a time");
}

int run(EvaluateArguments arguments) {
  arguments.truth = input_name(arguments.truth);
  for (std::string& estimate : arguments.estimates) estimate = input_name(estimate);
  check_usage(arguments);
  const std::filesystem::path plots = arguments.plots;
  require_new_files({arguments.json, arguments.csv, arguments.write, plots.empty() ? plots : plots / top_view_file,
                     plots.empty() ? plots : plots / error_over_time_file},
                    arguments.overwrite);
  const TrajectoryCorrection correction = correction_of_truth(arguments);
  arguments.options.alignment = parse_alignment(arguments.alignment).value();
  arguments.options.truth_name = arguments.truth;
  if (!correction.text().empty()) arguments.options.truth_frame = correction.text();
  Reference reference;
  reference.reading.format = find_trajectory_format(arguments.format);
  if (!arguments.times.empty()) reference.reading.stamps = read_frame_stamps(arguments.times);
  reference.truth = corrected(correction, read_with_notes(arguments.truth, reference.reading));
  if (!arguments.frames.empty()) reference.frames = read_frame_stamps(arguments.frames);

  const bool is_single = arguments.estimates.size() == 1;
  std::vector<ComparedEstimate> estimates;
  for (const std::string& file : arguments.estimates)
    estimates.push_back(is_single ? compare(arguments, reference, file)
                                  : compare_one_of_several(arguments, reference, file));
  const Evaluation* only = is_single ? &*estimates.front().evaluation : nullptr;
  if (arguments.json != "-" && arguments.csv != "-") {
    std::cout << (only != nullptr ? bold_labels(printable(to_text(*only)), STDOUT_FILENO)
                                  : printable(comparison_text(estimates)));
    if (!reference.frames) std::cout << "Coverage needs --frames LIST.\n";
    std::cout << std::flush;
  }
  if (!arguments.json.empty())
    write_output(arguments.json, only != nullptr ? to_json(*only) : comparison_json(estimates));
  if (!arguments.csv.empty()) write_output(arguments.csv, only != nullptr ? to_csv(*only) : comparison_csv(estimates));
  if (!arguments.plots.empty()) write_plots(arguments.plots, *only);
  for (const ComparedEstimate& estimate : estimates) print_suspicions(estimate, !is_single);
  return std::all_of(estimates.begin(), estimates.end(), [](const auto& e) { return e.evaluation.has_value(); }) ? 0
                                                                                                                 : 1;
}

/// A finite number, or the word 'estimate'.
CLI::Validator offset_or_estimate() {
  return CLI::Validator(
      [](const std::string& text) {
        const auto number = parsed_number<double>(text);
        const bool is_finite = number && std::isfinite(*number);
        return is_finite || text == "estimate" ? std::string()
                                               : "found '" + text + "'; expected a number of seconds, or 'estimate'";
      },
      "");
}

void add_correction_options(CLI::App& command, EvaluateArguments& arguments) {
  command
      .add_option("--time-offset", arguments.time_offset,
                  "Seconds added to the stamps of the estimate, for clocks that differ; 'estimate' finds them")
      ->type_name("S")
      ->check(offset_or_estimate())
      ->capture_default_str();
  command
      .add_option("--invert", arguments.inverted,
                  "Poses of this trajectory map the world to the camera (T_camera_world): truth, estimate or both")
      ->type_name("WHICH")
      ->check(CLI::IsMember({"truth", "estimate", "both"}));
  command
      .add_option("--mirror", arguments.mirrored,
                  "Axis of the world and the camera that is reversed in the truth, for a left-handed frame")
      ->type_name("AXIS")
      ->check(CLI::IsMember({"x", "y", "z"}));
  command.add_option("--mirror-estimate", arguments.mirrored_estimate, "The same for the estimate")
      ->type_name("AXIS")
      ->check(CLI::IsMember({"x", "y", "z"}));
  const auto add_unit = [&](const char* option, std::string& unit, const char* explanation) {
    command.add_option(option, unit, explanation)
        ->type_name("UNIT")
        ->check(CLI::IsMember({"m", "cm", "mm"}))
        ->capture_default_str();
  };
  add_unit("--truth-unit", arguments.truth_unit, "Unit of length of the truth");
  add_unit("--estimate-unit", arguments.estimate_unit, "Unit of length of the estimate");
}

}  // namespace

void add_evaluate_command(CLI::App& app, int& exit_code) {
  const auto arguments = std::make_shared<EvaluateArguments>();
  CLI::App* command =
      app.add_subcommand("evaluate", "Compare an estimated trajectory with the truth: ATE, RPE, coverage");
  command->footer(evaluate_explanation);
  command->add_option("TRUTH", arguments->truth, "True trajectory; '-': standard input")->required();
  command->add_option("ESTIMATE", arguments->estimates, "Estimated trajectory, or several; '-': standard input")
      ->required()
      ->expected(1, CLI::detail::expected_max_vector_size);
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
  add_correction_options(*command, *arguments);
  command->add_option("--json", arguments->json, "Also write the figures as JSON; '-': to standard output, no table")
      ->type_name("FILE");
  command->add_option("--csv", arguments->csv, "Also write the figures as CSV; '-': to standard output, no table")
      ->type_name("FILE");
  command->add_option("--plots", arguments->plots, "Write trajectory.svg and error.svg into this folder")
      ->type_name("DIR");
  add_overwrite_option(*command, arguments->overwrite);
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace holdfast
