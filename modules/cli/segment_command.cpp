// SPDX-License-Identifier: BSD-3-Clause
#include "segment_command.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <opencv2/core/utility.hpp>
#include <optional>
#include <string>
#include <vector>

#include "configured_command.hpp"
#include "holdfast/config/configuration.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/stage_times.hpp"
#include "holdfast/evaluation/number_text.hpp"
#include "holdfast/run/configured_pipeline.hpp"
#include "label_writer.hpp"
#include "program_host.hpp"
#include "segmentation_picture.hpp"
#include "source_interrupter.hpp"
#include "terminal.hpp"

namespace holdfast {

namespace {

struct SegmentArguments : ConfiguredArguments {
  std::uint64_t every = 1;
  std::uint64_t frames = 0;  ///< to segment; 0 = all
  bool pictures = false;
};

struct Counts {
  std::uint64_t asked = 0;  ///< frames that the segmenter was given
  double seconds = 0.0;     ///< that it took for them
};

/// Until the source ends, as many frames as asked for are done, a signal comes or something throws.
void segment_frames(BuiltSegmenter& built, const SegmentArguments& arguments, LabelWriter& writer, Counts& counts) {
  Progress progress(built.source->describe().frame_count, arguments.quiet);
  const SourceInterrupter interrupter(*built.source);
  std::uint64_t done = 0;
  while (!interrupted()) {
    const std::optional<SensorFrame> frame = built.source->next();
    if (!frame) return;
    if (done++ % arguments.every == 0) {
      const Stopwatch watch;
      const Segmentation segmentation = built.segmenter->segment(*frame);
      counts.seconds += watch.seconds();
      ++counts.asked;
      if (!segmentation.empty())
        writer.write(frame->timestamp, segmentation.labels,
                     arguments.pictures ? segmentation_picture(frame->colour, segmentation, built.segmenter->classes())
                                        : cv::Mat());
    }
    progress.update(done);
    if (counts.asked == arguments.frames) return;
  }
}

int segment(const SegmentArguments& arguments, const ProgramHost& host) {
  cv::setNumThreads(1);  // as `run` does; the segmenter may ask for more
  catch_interrupts();
  Registry registry = host.modules();
  const Configuration configuration = load_configuration(arguments.configuration, arguments.overrides, registry);
  BuiltSegmenter built = build_segmenter(configuration, registry);
  LabelWriter writer(arguments.output, built.segmenter->classes(), arguments.overwrite);

  Counts counts;
  std::string failure;
  try {
    segment_frames(built, arguments, writer, counts);
  } catch (const std::exception& error) {
    failure = error.what();
  }
  writer.finish();
  const auto done = static_cast<std::size_t>(counts.asked);
  const std::string written = counted(writer.count(), "label image") + (writer.count() == 1 ? " is in " : " are in ") +
                              arguments.output.string();
  if (!failure.empty())
    print_error(failure + "\n" + written);
  else if (interrupted())
    std::fprintf(stderr, "interrupted; %s\n", printable(written).c_str());
  else if (writer.count() == 0)
    print_error("the segmenter '" + configuration.segmenter.name + "' had nothing for any of " +
                counted(done, "frame") + "; is it of this recording?");
  else if (!arguments.quiet)
    std::printf("%s, for %s, at %.1f ms a frame\n", printable(written).c_str(), counted(done, "frame").c_str(),
                1e3 * counts.seconds / static_cast<double>(done));
  if (!arguments.quiet && writer.count() > 0)
    std::printf("\nTo use them:\n\n%s", writer.configuration(arguments.every == 1).c_str());
  return interrupted() ? interrupted_exit_code() : failure.empty() && writer.count() > 0 ? 0 : 1;
}

}  // namespace

void add_segment_command(CLI::App& app, int& exit_code, const ProgramHost& host) {
  auto arguments = std::make_shared<SegmentArguments>();
  CLI::App* command = app.add_subcommand("segment", "Segment a recording once, for the segmenter 'precomputed'");
  command->footer(
      "\nRuns the source and the segmenter of a configuration, nothing else, so that a slow network works once and "
      "every\n"
      "run after it is fast. Writes into the output folder:\n"
      "  STAMP.png     labels of a frame: index into the classes, 255 = unknown\n"
      "  labels.txt    the list of them          classes.yaml  what the values mean\n"
      "  STAMP.jpg     with --pictures: the frame with its masks, for people\n"
      "and prints what to put into a configuration to use them. Exits 0 when the source came to its end, 130\n"
      "on Ctrl-C, 143 on SIGTERM (what was done is kept), 2 when the configuration is wrong, 1 for anything else.\n\n"
      "Examples\n"
      "  holdfast segment rgbd.yaml --set 'segmenter={onnx: {model: net.onnx, classes: [background, person]}}' \\\n"
      "    --output out/labels\n"
      "  holdfast segment simulated.yaml --set segmenter=truth --output out/labels --every 5\n"
      "  holdfast segment yolo.yaml --frames 1 --pictures --output out/look");
  add_configured_options(*command, *arguments, "Folder for the label images",
                         "Replace the label images of an earlier run in the folder");
  command->add_option("--every", arguments->every, "Segment every N-th frame only")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1000000}))
      ->capture_default_str();
  command->add_option("--frames", arguments->frames, "Segment as many frames only, and end")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1000000000}));
  command->add_flag("--pictures", arguments->pictures, "Also write each segmented frame with its masks, as a JPEG");
  command->callback([arguments, host, &exit_code] { exit_code = segment(*arguments, host); });
}

}  // namespace holdfast
