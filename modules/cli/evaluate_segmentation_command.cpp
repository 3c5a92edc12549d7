// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate_segmentation_command.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <memory>
#include <opencv2/core/utility.hpp>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/config/configuration.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/size_text.hpp"
#include "holdfast/core/stage_times.hpp"
#include "holdfast/core/text_file.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/evaluation/segmentation_evaluation.hpp"
#include "holdfast/pipeline/configured_pipeline.hpp"
#include "installed_files.hpp"
#include "label_folder.hpp"
#include "output_file.hpp"
#include "program_host.hpp"
#include "source_interrupter.hpp"
#include "terminal.hpp"
#include "usage_error.hpp"

namespace holdfast {

namespace {

namespace fs = std::filesystem;

struct EvaluateSegmentationArguments {
  std::string configuration;
  std::vector<std::string> overrides;
  std::string labels, predictions, images;
  std::string label_map, prediction_map;
  std::string list, json;
  std::uint64_t every = 1;
  bool overwrite = false, quiet = false;
};

constexpr const char* evaluate_segmentation_explanation = R"(
Compares, with the true labels in --labels,
  --predictions DIR        label images of the same names
  CONFIG --images DIR      what the segmenter of a configuration finds in images of the same names
or, without --labels,
  CONFIG                   what it finds in the frames of a source that knows the truth

What the values of label images mean is said by --label-map and --prediction-map, values and ranges by
class name; 'unknown' is reserved for pixels that nobody is sure of, which are not counted. Without a
map, classes.yaml in the folder says it, which `holdfast segment` writes. Classes are compared by name;
what the predictions name and the labels do not is background.

Definitions
  IoU        pixels that are and were found to be of the class / pixels that are or were found to be
  accuracy   correctly labelled pixels / true pixels
  detected   of the images that show the class, those where its IoU is above 0.5
  boundary   IoU of the outlines, 2 % of the image's diagonal wide (person only)
  calibr.    mean difference between the confidence of pixels found to be of the class and the share of
             them that are; of a segmenter with confidence

Examples
  holdfast evaluate-segmentation --labels masks --label-map '{1-254: person}' --predictions out/labels
  holdfast evaluate-segmentation full.yaml --set segmenter=unet --images rgb --labels masks \
    --label-map '{1-254: person}' --json -
  holdfast evaluate-segmentation simulated.yaml --set segmenter=unet --every 10
)";

/// The names that a list gives, one a line; '#' begins a comment line.
std::vector<std::string> read_names(const fs::path& file) {
  LineReader lines(file, "a file with one image name a line");
  std::vector<std::string> names;
  for (std::string line; lines.next(line);)
    if (!line.empty() && line.front() != '#') names.push_back(line);
  if (names.empty()) throw InputError({file.string()}, "names no image; expected one name a line");
  return names;
}

void require_same_size(const fs::path& file, const cv::Size& found, const cv::Size& labels) {
  if (found != labels)
    throw InputError({file.string()}, "is " + size_text(found.width, found.height) + " pixels, its labels " +
                                          size_text(labels.width, labels.height) + "; expected the same size");
}

/// A label image and its counterpart.
struct Pair {
  fs::path labels, other;
};

/// Those with labels and a counterpart, and of a list all: a name of it that lacks one is an error.
std::vector<Pair> pairs_of(const EvaluateSegmentationArguments& arguments,
                           const std::map<std::string, fs::path>& labels,
                           const std::map<std::string, fs::path>& others) {
  std::vector<Pair> pairs;
  if (arguments.list.empty()) {
    for (const auto& [name, file] : labels)
      if (const auto other = others.find(name); other != others.end()) pairs.push_back({file, other->second});
    if (pairs.empty())
      throw InputError({arguments.labels}, "has no image whose name, such as '" + labels.begin()->first +
                                               "', is also in the other folder, which has '" + others.begin()->first +
                                               "'");
    return pairs;
  }
  for (const std::string& name : read_names(arguments.list)) {
    const auto label = labels.find(name), other = others.find(name);
    if (label == labels.end() || other == others.end())
      throw InputError({arguments.list},
                       "names '" + name + "', which has no " +
                           (label == labels.end() ? "label image in " + arguments.labels : std::string("counterpart")));
    pairs.push_back({label->second, other->second});
  }
  return pairs;
}

/// What there is to say, and the time that the segmenter took, where one ran.
struct Outcome {
  SegmentationEvaluation evaluation;
  std::optional<double> seconds_per_image;
};

template <class Found>
Outcome compare(const EvaluateSegmentationArguments& arguments, const std::map<std::string, fs::path>& others,
                LabelFolder& labels, const Found& found_of) {
  SegmentationEvaluator evaluator(labels.classes());
  const std::vector<Pair> pairs = pairs_of(arguments, labels.files(), others);
  Progress progress(pairs.size(), arguments.quiet);
  for (std::size_t i = 0; i < pairs.size() && !interrupted(); i += arguments.every) {
    const cv::Mat truth = labels.read(pairs[i].labels);
    const Segmentation found = found_of(pairs[i].other, truth);
    evaluator.add(truth, found.labels, found.confidence);
    progress.update(i + 1);
  }
  return {evaluator.result(), {}};
}

Outcome compare_folders(const EvaluateSegmentationArguments& arguments) {
  LabelFolder labels(arguments.labels, arguments.label_map, "--label-map");
  LabelFolder predictions(arguments.predictions, arguments.prediction_map, "--prediction-map");
  return compare(arguments, predictions.files(), labels, [&](const fs::path& file, const cv::Mat& truth) {
    const cv::Mat found = predictions.read(file);
    require_same_size(file, found.size(), truth.size());
    return Segmentation{translated(found, predictions.classes(), labels.classes()), {}};
  });
}

Outcome segment_images(const EvaluateSegmentationArguments& arguments, const Configuration& configuration,
                       const Registry& registry) {
  LabelFolder labels(arguments.labels, arguments.label_map, "--label-map");
  const auto segmenter =
      registry.create<Segmenter>(configuration.segmenter.name, configuration.segmenter.values, CreationContext{});
  ImageDecoder decoder;
  double seconds = 0.0;
  const auto images = files_by_stem(arguments.images, {".png", ".jpg", ".jpeg"});
  Outcome outcome = compare(arguments, images, labels, [&](const fs::path& file, const cv::Mat& truth) {
    SensorFrame frame;
    frame.colour =
        decoder.read_colour(file, [&](const cv::Size& size) { require_same_size(file, size, truth.size()); });
    const Stopwatch watch;
    const Segmentation found = segmenter->segment(frame);
    seconds += watch.seconds();
    if (found.empty()) throw InputError({file.string()}, "the segmenter has nothing for this image");
    return Segmentation{translated(found.labels, segmenter->classes(), labels.classes()), found.confidence};
  });
  outcome.seconds_per_image = seconds / static_cast<double>(outcome.evaluation.images);
  return outcome;
}

Outcome segment_source(const EvaluateSegmentationArguments& arguments, const Configuration& configuration,
                       const Registry& registry) {
  BuiltSegmenter built = build_segmenter(configuration, registry);
  const SourceDescription description = built.source->describe();
  const std::vector<std::string>& known = description.class_names;
  if (known.empty())
    throw InputError({arguments.configuration},
                     "the source does not know the classes of its pixels; give true labels with --labels, and the "
                     "images with --images");
  std::vector<std::string> classes = {known.front()};
  for (const std::string& name : built.segmenter->classes())
    if (name != known.front() && std::find(known.begin(), known.end(), name) != known.end()) classes.push_back(name);
  SegmentationEvaluator evaluator(classes);
  Progress progress(description.frame_count, arguments.quiet);
  const SourceInterrupter interrupter(*built.source);
  double seconds = 0.0;
  std::uint64_t done = 0;
  while (!interrupted()) {
    const std::optional<SensorFrame> frame = built.source->next();
    if (!frame) break;
    if (done++ % arguments.every == 0 && frame->truth) {
      const Stopwatch watch;
      const Segmentation found = built.segmenter->segment(*frame);
      seconds += watch.seconds();
      if (!found.empty())
        evaluator.add(translated(frame->truth->class_labels, known, classes),
                      translated(found.labels, built.segmenter->classes(), classes), found.confidence);
    }
    progress.update(done);
  }
  return {evaluator.result(), seconds / static_cast<double>(evaluator.result().images)};
}

Outcome evaluate_by(const EvaluateSegmentationArguments& arguments, const ProgramHost& host) {
  if (arguments.configuration.empty()) {
    if (arguments.labels.empty() || arguments.predictions.empty())
      throw UsageError("nothing to compare; expected --labels with --predictions, or a configuration");
    return compare_folders(arguments);
  }
  if (!arguments.predictions.empty())
    throw UsageError("a configuration and --predictions are two sources of predictions; give one of them");
  if (arguments.images.empty() != arguments.labels.empty())
    throw UsageError("--images and --labels belong together; give both, or none to ask the source for the truth");
  cv::setNumThreads(1);  // as `run` does; the segmenter may ask for more
  Registry registry = host.modules();
  const Configuration configuration = load_configuration(arguments.configuration, arguments.overrides, registry);
  return arguments.images.empty() ? segment_source(arguments, configuration, registry)
                                  : segment_images(arguments, configuration, registry);
}

int run(const EvaluateSegmentationArguments& arguments, const ProgramHost& host) {
  catch_interrupts();
  require_new_files({arguments.json}, arguments.overwrite);
  const Outcome outcome = evaluate_by(arguments, host);
  if (outcome.evaluation.images == 0) throw Error("no image was compared");
  if (arguments.json != "-") std::cout << bold_labels(to_text(outcome.evaluation), STDOUT_FILENO);
  if (arguments.json != "-" && outcome.seconds_per_image)
    std::cout << "segmented at " << static_cast<int>(1e4 * *outcome.seconds_per_image + 0.5) / 10.0
              << " ms an image, reading not included\n";
  if (!arguments.json.empty()) write_output(arguments.json, to_json(outcome.evaluation));
  return interrupted() ? interrupted_exit_code() : 0;
}

}  // namespace

void add_evaluate_segmentation_command(CLI::App& app, int& exit_code, const ProgramHost& host) {
  const auto arguments = std::make_shared<EvaluateSegmentationArguments>();
  CLI::App* command =
      app.add_subcommand("evaluate-segmentation", "Compare label images, or a segmenter, with the truth");
  command->footer(evaluate_segmentation_explanation);
  command->add_option("CONFIG", arguments->configuration, "Configuration in YAML, whose segmenter is measured")
      ->transform([](const std::string& given) { return find_file(given, InstalledFolder::configurations); });
  command->add_option("--labels", arguments->labels, "Folder of true label images (PNG)")->type_name("DIR");
  command->add_option("--predictions", arguments->predictions, "Folder of label images to compare with them")
      ->type_name("DIR");
  command->add_option("--images", arguments->images, "Folder of colour images (PNG, JPEG) for the segmenter")
      ->type_name("DIR");
  command->add_option("--label-map", arguments->label_map, "What the values in --labels mean: '{1-254: person}'")
      ->type_name("MAP");
  command->add_option("--prediction-map", arguments->prediction_map, "The same for --predictions")->type_name("MAP");
  command->add_option("--list", arguments->list, "File of the names, without ending, to compare; otherwise all")
      ->type_name("FILE");
  command->add_option("--every", arguments->every, "Compare every N-th only")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1000000}))
      ->capture_default_str();
  command->add_option("--set", arguments->overrides, "key.path=value: as if the configuration said so; may be repeated")
      ->allow_extra_args(false);
  command->add_option("--json", arguments->json, "Also write the figures as JSON; '-': to standard output, no table")
      ->type_name("FILE");
  add_overwrite_option(*command, arguments->overwrite);
  command->add_flag("-q,--quiet", arguments->quiet, "No progress");
  command->callback([arguments, host, &exit_code] { exit_code = run(*arguments, host); });
}

}  // namespace holdfast
