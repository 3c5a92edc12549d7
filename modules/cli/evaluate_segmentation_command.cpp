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
#include "holdfast/core/cell_mask.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/size_text.hpp"
#include "holdfast/core/stage_times.hpp"
#include "holdfast/core/text_file.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/evaluation/instance_evaluation.hpp"
#include "holdfast/evaluation/segmentation_evaluation.hpp"
#include "holdfast/run/configured_pipeline.hpp"
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
  bool instances = false, overwrite = false, quiet = false;
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
  AP50, AP   of instances, where the segmenter and the truth separate them: average precision at an IoU of
             0.5, and its mean over 0.5 to 0.95 (COCO)
  PQ         panoptic quality: sum of the IoUs above 0.5 / (pairs + half of what has no counterpart)
  calibr.    mean difference between the confidence of pixels found to be of the class and the share of
             them that are; of a segmenter with confidence

Examples
  holdfast evaluate-segmentation --labels masks --label-map '{1-254: person}' --predictions out/labels
  holdfast evaluate-segmentation full.yaml --set segmenter=unet --images rgb --labels masks \
    --label-map '{1-254: person}' --json -
  holdfast evaluate-segmentation yolo.yaml --images PNGImages --labels PedMasks --instances \
    --label-map '{1-254: person}'
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

/// Where the label of one list of classes is in another; background if it is not there.
std::uint8_t translated_label(std::uint8_t label, const std::vector<std::string>& from,
                              const std::vector<std::string>& to) {
  const auto place = std::find(to.begin(), to.end(), from[label]);
  return place == to.end() ? std::uint8_t{0} : static_cast<std::uint8_t>(place - to.begin());
}

/// The objects of a source's mask (8UC1) with the classes of their pixels.
InstanceImage true_instances(const cv::Mat& objects, const cv::Mat& labels) {
  InstanceImage image{cv::Mat::zeros(objects.size(), CV_16UC1), std::vector<InstanceImage::Entry>(255)};
  for (int y = 0; y < objects.rows; ++y)
    for (int x = 0; x < objects.cols; ++x) {
      const std::uint8_t object = objects.at<std::uint8_t>(y, x), label = labels.at<std::uint8_t>(y, x);
      if (object == 0 || !CellMask::is_object(label)) continue;
      image.instances.at<std::uint16_t>(y, x) = object;
      image.entries[object - 1U].label = label;
    }
  return image;
}

/// What there is to say, and the time that the segmenter took, where one ran.
struct Outcome {
  SegmentationEvaluation evaluation;
  std::optional<double> seconds_per_image;
  std::optional<InstanceEvaluation> instances = {};
};

/// Instances of a segmentation with the labels of another list of classes; those of other classes do not count.
InstanceImage translated_instances(const Segmentation& found, const std::vector<std::string>& from,
                                   const std::vector<std::string>& to) {
  InstanceImage image{found.instances, {}};
  for (const Instance& instance : found.found) {
    image.entries.push_back({translated_label(instance.label, from, to), instance.score});
  }
  return image;
}

/// An image's segmentation and its instances.
struct Found {
  Segmentation segmentation;
  InstanceImage instances = {};
};

template <class Find>
Outcome compare(const EvaluateSegmentationArguments& arguments, const std::map<std::string, fs::path>& others,
                LabelFolder& labels, const Find& found_of) {
  SegmentationEvaluator evaluator(labels.classes());
  InstanceEvaluator instances(labels.classes());
  const std::vector<Pair> pairs = pairs_of(arguments, labels.files(), others);
  Progress progress(pairs.size(), arguments.quiet);
  for (std::size_t i = 0; i < pairs.size() && !interrupted(); i += arguments.every) {
    const auto [truth, true_instances] = labels.read_instances(pairs[i].labels);
    const Found found = found_of(pairs[i].other, truth);
    evaluator.add(truth, found.segmentation.labels, found.segmentation.confidence);
    if (arguments.instances) instances.add(true_instances, found.instances, truth != CellMask::unknown);
    progress.update(i + 1);
  }
  return {evaluator.result(), {}, arguments.instances ? std::optional(instances.result()) : std::nullopt};
}

Outcome compare_folders(const EvaluateSegmentationArguments& arguments) {
  LabelFolder labels(arguments.labels, arguments.label_map, "--label-map");
  LabelFolder predictions(arguments.predictions, arguments.prediction_map, "--prediction-map");
  return compare(arguments, predictions.files(), labels, [&](const fs::path& file, const cv::Mat& truth) {
    auto [found, instances] = predictions.read_instances(file);
    require_same_size(file, found.size(), truth.size());
    for (InstanceImage::Entry& entry : instances.entries)
      entry.label = translated_label(entry.label, predictions.classes(), labels.classes());
    return Found{{translated(found, predictions.classes(), labels.classes()), {}}, std::move(instances)};
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
    if (arguments.instances && found.instances.empty())
      throw InputError({file.string()},
                       "the segmenter separates no instances in this image; leave --instances out, or "
                       "choose a segmenter that does, such as `onnx` with a network for instances");
    return Found{{translated(found.labels, segmenter->classes(), labels.classes()), found.confidence},
                 translated_instances(found, segmenter->classes(), labels.classes())};
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
  InstanceEvaluator instances(classes);
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
      if (!found.empty()) {
        const cv::Mat truth = translated(frame->truth->class_labels, known, classes);
        evaluator.add(truth, translated(found.labels, built.segmenter->classes(), classes), found.confidence);
        if (!found.instances.empty() && frame->truth->object_mask.size() == truth.size())
          instances.add(true_instances(frame->truth->object_mask, truth),
                        translated_instances(found, built.segmenter->classes(), classes), truth != CellMask::unknown);
      }
    }
    progress.update(done);
  }
  const InstanceEvaluation of_instances = instances.result();
  if (arguments.instances && of_instances.images == 0)
    throw InputError({arguments.configuration}, "the segmenter separates no instances; leave --instances out");
  return {evaluator.result(), seconds / static_cast<double>(evaluator.result().images),
          of_instances.images > 0 ? std::optional(of_instances) : std::nullopt};
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
  if (arguments.json != "-" && outcome.instances) std::cout << bold_labels(to_text(*outcome.instances), STDOUT_FILENO);
  if (arguments.json != "-" && outcome.seconds_per_image)
    std::cout << "segmented at " << static_cast<int>(1e4 * *outcome.seconds_per_image + 0.5) / 10.0
              << " ms an image, reading not included\n";
  if (!arguments.json.empty()) write_output(arguments.json, to_json(outcome.evaluation, outcome.instances));
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
  command->add_flag("--instances", arguments->instances,
                    "Score instances too: each value in --labels (and --predictions) is one object");
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
