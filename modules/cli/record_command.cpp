// SPDX-License-Identifier: BSD-3-Clause
#include "record_command.hpp"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "bag_recorder.hpp"
#include "configured_command.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/evaluation/number_text.hpp"
#include "holdfast/run/configured_pipeline.hpp"
#include "recorder.hpp"
#include "source_interrupter.hpp"
#include "terminal.hpp"
#include "usage_error.hpp"

namespace holdfast {

namespace {

struct RecordArguments : ConfiguredArguments {
  std::uint64_t frames = 0;
  std::filesystem::path bag;
};

/// Until the source ends, a signal comes, there are enough frames or something throws.
template <class AnyRecorder>
void record_frames(FrameSource& source, const RecordArguments& arguments, AnyRecorder& recorder) {
  std::optional<std::uint64_t> total = source.describe().frame_count;
  if (arguments.frames > 0) total = std::min(total.value_or(arguments.frames), arguments.frames);
  Progress progress(total, arguments.quiet);
  const SourceInterrupter interrupter(source);
  for (std::uint64_t count = 0; !interrupted() && (arguments.frames == 0 || count < arguments.frames);) {
    const std::optional<SensorFrame> frame = source.next();
    if (!frame) return;
    recorder.record(*frame);
    progress.update(++count);
  }
}

/// Records the source, and says what was recorded. Returns the exit code.
template <class AnyRecorder>
int record_source(FrameSource& source, const RecordArguments& arguments, AnyRecorder& recorder) {
  std::string failure;
  try {
    record_frames(source, arguments, recorder);
  } catch (const std::exception& error) {
    failure = error.what();
  }
  try {
    recorder.finish(source.truth());
  } catch (const std::exception& error) {
    if (failure != error.what()) failure += (failure.empty() ? "" : "\n") + std::string(error.what());
  }
  const std::string written = counted(recorder.frame_count(), "frame") + " recorded in " + recorder.target().string();
  if (!failure.empty()) {
    print_error(failure + "\n" + written);
    return 1;
  }
  if (recorder.frame_count() == 0) {
    print_error("the source gave no frame, so that there is nothing to record");
    return interrupted() ? interrupted_exit_code() : 1;
  }
  if (const std::string losses = recorder.losses(); !losses.empty()) print_warning(losses);
  if (!arguments.quiet || interrupted())
    std::printf("%s%s\nTo run it: holdfast run %s --output DIR\n", interrupted() ? "interrupted: " : "",
                printable(written).c_str(), printable(recorder.configuration_file().string()).c_str());
  return interrupted() ? interrupted_exit_code() : 0;
}

void check_targets(const RecordArguments& arguments) {
  if (arguments.bag.empty() == arguments.output.empty())
    throw UsageError("expected either --output DIR or --bag FILE.mcap");
  if (!arguments.bag.empty() && arguments.bag.extension() != ".mcap")
    throw UsageError("--bag " + arguments.bag.string() + ": expected a name that ends with .mcap");
}

int record(const RecordArguments& arguments, const ProgramHost& host) {
  check_targets(arguments);
  catch_interrupts();
  Registry registry = host.modules();
  const Configuration configuration = load_configuration(arguments.configuration, arguments.overrides, registry);
  print_warnings(configuration.warnings);
  const std::unique_ptr<FrameSource> source = build_source(configuration, registry);
  print_warnings(source->warnings());
  const SourceDescription description = source->describe();
  if (!arguments.bag.empty()) {
    BagRecorder recorder(configuration, registry, description, arguments.bag, arguments.overwrite);
    return record_source(*source, arguments, recorder);
  }
  Recorder recorder(configuration, registry, description, arguments.output, arguments.overwrite);
  return record_source(*source, arguments, recorder);
}

}  // namespace

void add_record_command(CLI::App& app, int& exit_code, const ProgramHost& host) {
  auto arguments = std::make_shared<RecordArguments>();
  CLI::App* command =
      app.add_subcommand("record", "Record the frames of any source, in TUM layout or as a bag of ROS 2");
  command->footer(
      "\nReads the source of a configuration, tracks nothing, and writes into the output folder:\n"
      "  rgb/, depth/       images, without loss where depth is in whole units of the sensor, else to 0.2 mm\n"
      "  rgb.txt, depth.txt, associations.txt  their lists\n"
      "  groundtruth.txt    where the source has truth               recording.yaml  the configuration, on the "
      "recording\n"
      "  imu.csv            where frames have inertial measurements\n"
      "or with --bag an MCAP file of ROS 2 with images, camera_info and inertial measurements, without loss, and "
      "beside "
      "it\n"
      "FILE.yaml, the configuration, on the recording, and FILE.truth.txt. A bag also holds one camera or a pair.\n"
      "`holdfast run --record DIR` records while it tracks. Exits 0 when the source came to its end, 130 on Ctrl-C, "
      "143\n"
      "on SIGTERM (what was recorded is whole), 2 when the configuration is wrong, 1 for anything else.\n\n"
      "Examples\n"
      "  holdfast record camera.yaml --output out/recording\n"
      "  holdfast record examples/configs/demo.yaml --output out/recording --frames 100\n"
      "  holdfast record examples/configs/demo.yaml --bag out/recording.mcap");
  add_configured_options(*command, *arguments, "Folder for the recording", "Replace a recording in the folder");
  command->get_option("--output")->required(false);
  command->add_option("--bag", arguments->bag, "MCAP file for the recording, instead of a folder");
  command->add_option("--frames", arguments->frames, "Stop after this number of frames")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1'000'000'000}));
  command->callback([arguments, host, &exit_code] { exit_code = record(*arguments, host); });
}

}  // namespace holdfast
