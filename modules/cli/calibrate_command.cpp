// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate_command.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "calibration_views.hpp"
#include "holdfast/calibration/calibration_output.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/evaluation/number_text.hpp"
#include "holdfast/run/configured_pipeline.hpp"
#include "output_file.hpp"
#include "positive_number.hpp"
#include "terminal.hpp"
#include "usage_error.hpp"

namespace holdfast {

namespace {

struct CalibrateArguments {
  std::vector<std::filesystem::path> images;
  std::string configuration;
  std::vector<std::string> overrides;
  std::string board = "9x6", pattern = "chessboard", lens = "radial_tangential", marker_cells = "5x5";
  double square = 0.0, marker = 0.75;
  int coefficients = 5;
  std::string output = "-", json, plot, print_board;
  bool keep_all_views = false, overwrite = false;
  CalibrationViews::Options views;
};

CalibrationBoard board_of(const CalibrateArguments& arguments) {
  CalibrationBoard board;
  board.pattern = find_board_pattern(arguments.pattern).value();
  char rest = 0;
  if (std::sscanf(arguments.board.c_str(), "%dx%d%c", &board.columns, &board.rows, &rest) != 2 || board.columns < 2 ||
      board.rows < 2 || board.columns > 100 || board.rows > 100)
    throw UsageError("found '" + arguments.board +
                     "' for --board; expected COLUMNSxROWS of inner corners, where four squares meet, such as 9x6 for "
                     "a board of 10 by 7 squares");
  if (arguments.square <= 0.0)
    throw UsageError("--square is required: the length of the side of a square in metres, such as 0.025");
  board.square = arguments.square;
  board.marker = arguments.marker;
  board.dictionary = arguments.marker_cells;
  return board;
}

void write_plot(const std::string& file, const Calibration& calibration, const CalibrationAssessment& assessment) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", calibration_plot(calibration, assessment), bytes);
  write_file_atomically(file, std::string(bytes.begin(), bytes.end()));
}

int print_board(const CalibrateArguments& arguments) {
  require_new_files({arguments.print_board}, arguments.overwrite);
  write_output(arguments.print_board, board_svg(board_of(arguments)));
  return 0;
}

/// The views of whatever the arguments name.
void collect(const CalibrateArguments& arguments, const ProgramHost& host, CalibrationViews& views) {
  if (arguments.configuration.empty()) return views.add_files(arguments.images);
  Registry registry = host.modules();
  const Configuration configuration = load_configuration(arguments.configuration, arguments.overrides, registry);
  print_warnings(configuration.warnings);
  views.add_source(*build_source(configuration, registry));
}

void require_views(const CalibrateArguments& arguments, const CalibrationViews& views) {
  constexpr std::size_t fewest = 3;
  if (views.views().size() >= fewest) return;
  const std::string place =
      arguments.configuration.empty() ? arguments.images.front().string() : arguments.configuration;
  throw InputError({place},
                   "found the board in " + std::to_string(views.views().size()) + " of " +
                       counted(views.looked_at(), "image") + "; expected it in at least 3, better 20. It must have " +
                       arguments.board + " inner corners (--board), where four squares meet" +
                       (arguments.pattern == "chessboard" ? ", and a white border, and be in the picture as a whole"
                                                          : " and the markers that `--print-board` draws") +
                       ", sharp and evenly lit");
}

int calibrate_camera(const CalibrateArguments& arguments, const ProgramHost& host) {
  if (arguments.images.empty() == arguments.configuration.empty())
    throw UsageError("expected either images, a folder of images or a video, or --config CONFIG");
  if (arguments.json == "-" && arguments.output == "-")
    throw UsageError(
        "--json and the camera cannot both go to standard output; give one of them a file (--output FILE)");
  if (arguments.configuration.empty() && !arguments.overrides.empty()) throw UsageError("--set needs --config CONFIG");
  const CalibrationBoard board = board_of(arguments);
  require_new_files({arguments.output, arguments.json, arguments.plot}, arguments.overwrite);
  catch_interrupts();
  CalibrationViews views(board, arguments.views);
  collect(arguments, host, views);
  if (interrupted()) return interrupted_exit_code();
  require_views(arguments, views);
  CalibrationOptions options;
  options.lens = find_lens(arguments.lens).value();
  options.coefficients = arguments.coefficients;
  options.keep_all_views = arguments.keep_all_views;
  const Calibration calibration = calibrate(views.views(), board, views.size().width, views.size().height, options);
  const CalibrationAssessment assessment = assess(calibration);

  // What is for people goes where the camera does not.
  const std::string text = "found the board in " + std::to_string(views.views().size()) + " of " +
                           counted(views.looked_at(), "image") + "\n" + to_text(calibration, assessment);
  if (!arguments.views.quiet && arguments.json != "-")
    std::fputs(printable(text).c_str(), arguments.output == "-" ? stderr : stdout);
  if (!arguments.json.empty()) write_output(arguments.json, to_json(calibration, assessment, board));
  if (!arguments.plot.empty()) write_plot(arguments.plot, calibration, assessment);
  if (!assessment.trouble.empty()) {
    std::fflush(stdout);  // the error comes after the report
    print_error(assessment.trouble + "; no camera was written");
    return 1;
  }
  write_output(arguments.output, camera_yaml(calibration, board));
  return 0;
}

void add_board_options(CLI::App& command, CalibrateArguments& arguments) {
  command.add_option("--board", arguments.board, "Inner corners of the board, where four squares meet")
      ->type_name("COLUMNSxROWS")
      ->capture_default_str();
  command.add_option("--square", arguments.square, "Length of the side of a square [m]; measure it")
      ->type_name("M")
      ->check(positive_number());
  command.add_option("--pattern", arguments.pattern, "chessboard; charuco: with markers, may be seen in part")
      ->type_name("PATTERN")
      ->check(CLI::IsMember(board_pattern_names()))
      ->capture_default_str();
  command.add_option("--marker", arguments.marker, "Side of a marker as a share of that of a square")
      ->type_name("SHARE")
      ->check(CLI::Range(0.3, 0.9))
      ->capture_default_str();
  command.add_option("--marker-cells", arguments.marker_cells, "Cells of a marker")
      ->type_name("CELLS")
      ->check(CLI::IsMember(marker_dictionaries()))
      ->capture_default_str();
  command
      .add_option("--print-board", arguments.print_board,
                  "Write the board as SVG in its true size, to print it; '-': to standard output")
      ->type_name("FILE");
}

constexpr const char* calibrate_explanation =
    "\nPhotograph a printed board twenty times: in every part of the image, near enough to fill a third of it, turned "
    "by\n"
    "20 to 45 degrees to each side, up and down. The report says how far the result can be trusted and what to "
    "photograph\n"
    "next; docs/calibration.md explains it. Images are PNG or JPEG files; of a video or a source, images are chosen "
    "in\n"
    "which the board stands elsewhere. Exits 1 when no board is found, or the views do not determine the camera.\n\n"
    "Examples\n"
    "  holdfast calibrate --print-board board.svg --board 9x6 --square 0.025\n"
    "  holdfast calibrate photographs --board 9x6 --square 0.0247 --output camera.yaml --plot calibration.png\n"
    "  holdfast calibrate --config camera_source.yaml --square 0.025 --lens fisheye --output camera.yaml";

}  // namespace

void add_calibrate_command(CLI::App& app, int& exit_code, const ProgramHost& host) {
  const auto arguments = std::make_shared<CalibrateArguments>();
  CLI::App* command = app.add_subcommand("calibrate", "Find the numbers of a camera from pictures of a board");
  command->footer(calibrate_explanation);
  command->add_option("IMAGES", arguments->images, "Folders of images, images, and videos");
  command->add_option("--config", arguments->configuration, "Take the images of this configuration's source instead")
      ->type_name("CONFIG");
  command->add_option("--set", arguments->overrides, "key.path=value: as if the file said so; may be repeated")
      ->allow_extra_args(false);
  add_board_options(*command, *arguments);
  command->add_option("--lens", arguments->lens, "Kind of the lens; fisheye: Kannala-Brandt, for wide angles")
      ->type_name("LENS")
      ->check(CLI::IsMember(lens_names()))
      ->capture_default_str();
  command
      ->add_option("--coefficients", arguments->coefficients,
                   "Of a radial_tangential lens: 4 (k1 k2 p1 p2), 5 (and k3), 8 (and k4 k5 k6, for wide angles)")
      ->type_name("COUNT")
      ->check(CLI::IsMember({4, 5, 8}))
      ->capture_default_str();
  command
      ->add_option("--every", arguments->views.every, "Of a video or a source, look at every N-th image; 0: every 5th")
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--views", arguments->views.most_views, "Of a video or a source, take at most this many")
      ->type_name("COUNT")
      ->check(CLI::Range(std::size_t{3}, std::size_t{1000}))
      ->capture_default_str();
  command->add_flag("--all-views", arguments->keep_all_views, "Also use views that disagree with the others");
  command->add_option("-o,--output", arguments->output, "Where the section `camera` goes; '-': standard output")
      ->type_name("FILE")
      ->capture_default_str();
  command->add_option("--json", arguments->json, "Also write the report as JSON; '-': to standard output, no text")
      ->type_name("FILE");
  command->add_option("--plot", arguments->plot, "Also write a picture of coverage and residuals (PNG)")
      ->type_name("FILE");
  add_overwrite_option(*command, arguments->overwrite);
  command->add_flag("-q,--quiet", arguments->views.quiet, "No progress, no report");
  command->callback([arguments, host, &exit_code] {
    exit_code = arguments->print_board.empty() ? calibrate_camera(*arguments, host) : print_board(*arguments);
  });
}

}  // namespace holdfast
