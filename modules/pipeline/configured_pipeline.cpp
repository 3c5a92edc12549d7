// SPDX-License-Identifier: BSD-3-Clause
#include <utility>

#include "camera_numbers.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/map_io/map_file.hpp"
#include "holdfast/pipeline/pipeline_builder.hpp"

namespace holdfast {

std::vector<SectionDescription> pipeline_sections() {
  return {
      {"tracking", "How poses are found, and when a frame becomes a keyframe.",
       ParameterTable<TrackingSettings>().parameters()},
      {"segmentation", "Which frames the segmenter sees, and when its answer counts.",
       ParameterTable<SegmentationSettings>().parameters()},
      {"evidence", "What becomes of the evidence that filters give.", ParameterTable<EvidenceSettings>().parameters()},
      {"mapping", "How the map around a new keyframe is made and kept.",
       ParameterTable<MappingSettings>().parameters()},
      {"loop_closing", "When a place counts as seen again, and how the map is corrected then.",
       ParameterTable<LoopClosingSettings>().parameters()},
      {"dense_map", "A dense cloud of the static scene, of what keyframes saw.",
       ParameterTable<DenseMapSettings>().parameters()}};
}

namespace {

/// The camera of the run: the configuration's or the source's; when both name one, they must agree.
Camera resolve_camera(const Configuration& configuration, const SourceDescription& source,
                      std::vector<Diagnostic>& diagnostics) {
  if (source.camera && configuration.camera && have_other_numbers(*source.camera, *configuration.camera))
    diagnostics.push_back(
        {configuration.source.location,
         "the source '" + configuration.source.name +
             "' brings its own camera, and the section 'camera' says something else; remove one of them"});
  if (source.camera) return *source.camera;
  if (configuration.camera) return *configuration.camera;
  std::string known;
  for (const std::string& name : camera_names()) known += (known.empty() ? "" : ", ") + name;
  diagnostics.push_back({SourceLocation{configuration.file},
                         "section 'camera' is missing, and the source '" + configuration.source.name +
                             "' does not know its camera; expected a name (" + known + ") or numbers"});
  return {};
}

/// What the source is told; the camera and the classes that it knows come afterwards.
CreationContext context_of_source(const Configuration& configuration) {
  CreationContext context;
  if (configuration.camera) context.camera = *configuration.camera;
  context.seed = configuration.run.seed;
  context.sequential = configuration.run.mode == "sequential";
  return context;
}

}  // namespace

/// Says to a builder what a configuration says.
class ConfigurationReader {
 public:
  ConfigurationReader(const Configuration& configuration, const Registry& registry)
      : configuration_(configuration), builder_(registry) {
    builder_.place_ = {configuration.file};
  }

  PipelineBuilder read(const SourceDescription& source) {
    builder_.source(source);
    // The camera is settled here, where messages can name the sections.
    builder_.source_camera_.reset();
    builder_.camera(resolve_camera(configuration_, source, builder_.diagnostics_));
    builder_.source_name_ = configuration_.source.name;
    builder_.source_place_ = configuration_.source.location;
    choose_modules();
    choose_settings();
    return std::move(builder_);
  }
  static void read_map_file(const std::filesystem::path& file, bool localise_only, PipelineBuilder& builder) {
    builder.map_name_ = file.string();
    if (localise_only)
      builder.localise_in(read_map(file));
    else
      builder.map(read_map(file));
  }

 private:
  template <class Interface>
  static ModuleOf<Interface> module(const ModuleChoice& choice) {
    ModuleOf<Interface> module(choice.name, choice.values);
    module.place = choice.location;
    return module;
  }
  template <class Settings>
  Settings section(const std::string& name) const {
    const auto found = configuration_.sections.find(name);
    return found == configuration_.sections.end() ? Settings{} : ParameterTable<Settings>().settings(found->second);
  }

  void choose_modules() {
    builder_.features(module<FeatureExtractor>(configuration_.features))
        .segmenter(module<Segmenter>(configuration_.segmenter))
        .optimizer(module<Optimizer>(configuration_.optimizer))
        .loop_detector(module<LoopDetector>(configuration_.loop_detector));
    for (const ModuleChoice& choice : configuration_.filters) builder_.filter(module<DynamicFilter>(choice));
    for (const ModuleChoice& choice : configuration_.observers) builder_.observer(module<Observer>(choice));
  }
  void choose_settings() {
    const RunSettings& run = configuration_.run;
    builder_.tracking(section<TrackingSettings>("tracking"))
        .segmentation(section<SegmentationSettings>("segmentation"))
        .evidence(section<EvidenceSettings>("evidence"))
        .mapping(section<MappingSettings>("mapping"))
        .loop_closing(section<LoopClosingSettings>("loop_closing"))
        .dense_map(section<DenseMapSettings>("dense_map"))
        .seed(run.seed)
        .threads({.threaded = run.mode != "sequential",
                  .keyframe_queue = static_cast<std::size_t>(run.keyframe_queue),
                  .unpaced = run.pace == "none"});
  }

  const Configuration& configuration_;
  PipelineBuilder builder_;
};

BuiltPipeline build_pipeline(const Configuration& configuration, const Registry& registry, const RunOptions& options) {
  HOLDFAST_CHECK(!options.localise_only || !options.map_file.empty(), "localising needs a map");
  CreationContext context = context_of_source(configuration);
  context.output_directory = options.output_directory;
  auto source = registry.create<FrameSource>(configuration.source.name, configuration.source.values, context);
  PipelineBuilder builder = ConfigurationReader(configuration, registry).read(source->describe());
  builder.output_directory(options.output_directory);
  if (!options.map_file.empty()) ConfigurationReader::read_map_file(options.map_file, options.localise_only, builder);
  return {std::move(source), builder.build()};
}

BuiltSegmenter build_segmenter(const Configuration& configuration, const Registry& registry) {
  if (configuration.segmenter.name == "none")
    throw ConfigurationError(
        configuration.segmenter.location.file.empty() ? SourceLocation{configuration.file}
                                                      : configuration.segmenter.location,
        "the segmenter is 'none', which finds nothing; choose one under 'segmenter:', such as 'onnx'");
  CreationContext context = context_of_source(configuration);
  auto source = registry.create<FrameSource>(configuration.source.name, configuration.source.values, context);
  const SourceDescription description = source->describe();
  std::vector<Diagnostic> diagnostics;
  context.camera = resolve_camera(configuration, description, diagnostics);
  context.class_names = description.class_names;
  if (!diagnostics.empty()) throw ConfigurationError(std::move(diagnostics));
  auto segmenter = registry.create<Segmenter>(configuration.segmenter.name, configuration.segmenter.values, context);
  return {std::move(source), std::move(segmenter)};
}

}  // namespace holdfast
