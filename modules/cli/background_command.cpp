// SPDX-License-Identifier: BSD-3-Clause
#include "background_command.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string>
#include <vector>

#include "configured_command.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/dense_map/background.hpp"
#include "holdfast/dense_map/static_scene.hpp"
#include "holdfast/evaluation/number_text.hpp"
#include "holdfast/run/run.hpp"
#include "output_folder.hpp"
#include "program_host.hpp"
#include "terminal.hpp"

namespace holdfast {

namespace {

struct BackgroundArguments : ConfiguredArguments {
  int every = 1;
};

constexpr const char* pictures_folder = "background";

void write_png(const std::filesystem::path& file, const cv::Mat& picture) {
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(".png", picture, bytes)) throw InputError({file.string()}, "this OpenCV cannot write PNG files");
  write_file_atomically(file, std::string(bytes.begin(), bytes.end()));
}

/// Pictures of every n-th kept keyframe, and a table of what was replaced in them.
std::size_t write_pictures(const StaticScene& scene, const Map& map, const BackgroundArguments& arguments) {
  const BackgroundPainter painter(scene, map);
  const std::filesystem::path folder = arguments.output / pictures_folder;
  std::filesystem::create_directories(folder);
  std::string table = "# timestamp frame replaced unknown (shares of the picture)\n";
  std::size_t count = 0;
  for (std::size_t i = 0; i < scene.views().size() && !interrupted(); i += static_cast<std::size_t>(arguments.every)) {
    const KeptView& view = scene.views()[i];
    const BackgroundPicture picture = painter.paint(i);
    char name[64], row[128];
    std::snprintf(name, sizeof(name), "%06llu", static_cast<unsigned long long>(view.frame_index));
    write_png(folder / (std::string(name) + "_before.png"), picture.before);
    write_png(folder / (std::string(name) + "_after.png"), picture.after);
    std::snprintf(row, sizeof(row), "%.6f %s %.4f %.4f\n", view.timestamp, name, picture.replaced, picture.unknown);
    table += row;
    ++count;
  }
  write_file_atomically(folder / "pictures.txt", table);
  return count;
}

int print_end(const BackgroundArguments& arguments, const RunRecord& record, std::size_t pictures) {
  const bool was_interrupted = record.was_interrupted || interrupted();
  if (!record.failure.empty())
    print_error(record.failure);
  else if (was_interrupted)
    std::fprintf(stderr, "interrupted; what was done is in %s\n", arguments.output.c_str());
  else if (!arguments.quiet)
    std::printf("%s, each before and after, in %s\n", counted(pictures, "keyframe").c_str(),
                (arguments.output / pictures_folder).c_str());
  if (was_interrupted) return interrupted_exit_code();
  return record.failure.empty() && pictures > 0 ? 0 : 1;
}

int draw_background(const BackgroundArguments& arguments, const ProgramHost& host) {
  cv::setNumThreads(1);
  catch_interrupts();
  Registry registry = host.modules();
  std::vector<std::string> overrides = {"dense_map.enabled=true"};
  overrides.insert(overrides.end(), arguments.overrides.begin(), arguments.overrides.end());
  const Configuration configuration = load_configuration(arguments.configuration, overrides, registry);
  BuiltPipeline built = build_pipeline(configuration, registry,
                                       {.output_directory = arguments.output, .map_file = {}, .localise_only = false});
  const StaticScene* scene = built.pipeline.static_scene();
  if (scene == nullptr) throw Error("dense_map.enabled was set to false; pictures need what it keeps");
  const FolderLock lock =
      prepare_output_folder(arguments.output, arguments.overwrite, {"config.yaml", pictures_folder, "overlay"});
  write_file_atomically(arguments.output / "config.yaml", to_yaml(configuration));

  std::optional<Progress> progress(std::in_place, built.source->describe().frame_count, arguments.quiet);
  RunOptions options;
  options.stop = interrupted;
  options.on_frame = [&](const RunProgress& run) { progress->update(run.frames_done, to_string(run.result.status)); };
  const RunRecord record = run(built, configuration, options);
  progress.reset();
  return print_end(arguments, record, write_pictures(*scene, built.pipeline.map(), arguments));
}

}  // namespace

void add_background_command(CLI::App& app, int& exit_code, const ProgramHost& host) {
  auto arguments = std::make_shared<BackgroundArguments>();
  CLI::App* command = app.add_subcommand("background", "Draw keyframes with what moves replaced by what is behind it");
  command->footer(
      "\nRuns the pipeline with `dense_map.enabled: true` and writes into DIR/background, per keyframe:\n"
      "  000120_before.png   the picture without lens distortion\n"
      "  000120_after.png    people and other moving things replaced by what other keyframes saw behind them;\n"
      "                      transparent (magenta below) where none has seen it\n"
      "  pictures.txt        timestamp, frame, replaced and unknown share of each picture\n"
      "What counts as moving is decided by the configuration's segmenter, filters and section dense_map.\n\n"
      "Examples\n"
      "  holdfast background dynamic.yaml --output out/empty_room\n"
      "  holdfast background dynamic.yaml --every 10 --set dense_map.step=1 --output out/full_size");
  add_configured_options(*command, *arguments);
  command->add_option("--every", arguments->every, "Draw every N-th of the kept keyframes")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->callback([arguments, host, &exit_code] { exit_code = draw_background(*arguments, host); });
}

}  // namespace holdfast
