// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/pipeline/configured_pipeline.hpp"

#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/map_io/map_file.hpp"
#include "holdfast/perturbation/perturbed_source.hpp"
#include "holdfast/pipeline/pipeline_builder.hpp"
#include "holdfast/plugin/loader.hpp"

namespace holdfast {

std::vector<SectionDescription> pipeline_sections() {
  return {
      {"tracking", "How poses are found, and when a frame becomes a keyframe.",
       ParameterTable<TrackingSettings>().parameters()},
      {"stereo", "How features get their depth from the right image of a rectified pair.",
       ParameterTable<StereoSettings>().parameters()},
      {"segmentation", "Which frames the segmenter sees, and when its answer counts.",
       ParameterTable<SegmentationSettings>().parameters()},
      {"evidence", "What becomes of the evidence that filters give.", ParameterTable<EvidenceSettings>().parameters()},
      {"mapping", "How the map around a new keyframe is made and kept.",
       ParameterTable<MappingSettings>().parameters()},
      {"loop_closing", "When a place counts as seen again, and how the map is corrected then.",
       ParameterTable<LoopClosingSettings>().parameters()},
      {"dense_map", "A dense cloud of the static scene, of what keyframes saw.",
       ParameterTable<DenseMapSettings>().parameters()},
      {"perturbation", "What is made worse about the frames of the source, to see what a configuration withstands.",
       ParameterTable<PerturbationSettings>().parameters()}};
}

Configuration load_configuration(const std::filesystem::path& file, const std::vector<std::string>& overrides,
                                 Registry& registry) {
  return read_configuration(file, overrides, registry, pipeline_sections());
}

void load_plugins(const Configuration& configuration, Registry& registry) {
  for (const std::string& file : configuration.plugins) load_plugin(registry, file);
}

namespace {

/// The context for the source. The camera and the classes that the source knows are added for the other modules.
CreationContext context_of_source(const Configuration& configuration) {
  CreationContext context;
  if (configuration.camera) context.camera = *configuration.camera;
  context.sensor = configuration.sensor;
  context.seed = configuration.run.seed;
  context.sequential = !configuration.run.threaded();
  return context;
}

PerturbationSettings perturbation_of(const Configuration& configuration) {
  const auto section = configuration.sections.find("perturbation");
  if (section == configuration.sections.end()) return {};
  return ParameterTable<PerturbationSettings>().settings(section->second);
}

std::unique_ptr<FrameSource> make_source(const Configuration& configuration, const Registry& registry,
                                         const CreationContext& context) {
  auto source = registry.create<FrameSource>(configuration.source.name, configuration.source.values, context);
  const PerturbationSettings perturbation = perturbation_of(configuration);
  if (perturbation.is_nothing()) return source;
  const Camera camera = source->describe().camera.value_or(context.camera);
  return std::make_unique<PerturbedSource>(std::move(source), perturbation, camera, configuration.run.seed);
}

}  // namespace

/// Passes the choices of a configuration to a builder, each with its place in the file.
class ConfigurationReader {
 public:
  ConfigurationReader(const Configuration& configuration, const Registry& registry)
      : configuration_(configuration), builder_(registry) {
    builder_.place_ = {configuration.file};
    builder_.unknown_camera_ = configuration.unknown_camera;
    builder_.is_camera_judged_ = true;
  }

  PipelineBuilder read(const SourceDescription& source) {
    builder_.source(source);
    if (configuration_.camera)
      builder_.camera(
          perturbed_camera(*configuration_.camera, perturbation_of(configuration_), configuration_.run.seed));
    if (configuration_.sensor) builder_.sensor(*configuration_.sensor);
    builder_.source_name_ = configuration_.source.name;
    builder_.source_place_ = configuration_.source.location;
    choose_modules();
    choose_settings();
    return std::move(builder_);
  }
  static std::unique_ptr<Segmenter> build_segmenter(PipelineBuilder builder) { return builder.build_segmenter(); }
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
    // The builder has this one, whether or not it is registered.
    if (configuration_.matcher.name != "nearest") builder_.matcher(module<FeatureMatcher>(configuration_.matcher));
    for (const ModuleChoice& choice : configuration_.filters) builder_.filter(module<DynamicFilter>(choice));
    for (const ModuleChoice& choice : configuration_.observers) builder_.observer(module<Observer>(choice));
  }
  void choose_settings() {
    builder_.tracking(section<TrackingSettings>("tracking"))
        .stereo(section<StereoSettings>("stereo"))
        .segmentation(section<SegmentationSettings>("segmentation"))
        .evidence(section<EvidenceSettings>("evidence"))
        .mapping(section<MappingSettings>("mapping"))
        .loop_closing(section<LoopClosingSettings>("loop_closing"))
        .dense_map(section<DenseMapSettings>("dense_map"))
        .run(configuration_.run);
  }

  const Configuration& configuration_;
  PipelineBuilder builder_;
};

BuiltPipeline build_pipeline(const Configuration& configuration, const Registry& registry,
                             const PipelineOptions& options) {
  HOLDFAST_CHECK(!options.localise_only || !options.map_file.empty(), "localising needs a map");
  CreationContext context = context_of_source(configuration);
  context.output_directory = options.output_directory;
  auto source = make_source(configuration, registry, context);
  PipelineBuilder builder = ConfigurationReader(configuration, registry).read(source->describe());
  builder.output_directory(options.output_directory);
  if (!options.map_file.empty()) ConfigurationReader::read_map_file(options.map_file, options.localise_only, builder);
  return {std::move(source), builder.build()};
}

Warnings BuiltPipeline::warnings() const {
  Warnings warnings = source->warnings();
  add_warnings(warnings, pipeline.warnings());
  return warnings;
}

std::unique_ptr<FrameSource> build_source(const Configuration& configuration, const Registry& registry) {
  auto source = make_source(configuration, registry, context_of_source(configuration));
  if (configuration.unknown_camera && !configuration.camera && !source->describe().camera)
    throw ConfigurationError({*configuration.unknown_camera});
  return source;
}

BuiltSegmenter build_segmenter(const Configuration& configuration, const Registry& registry) {
  std::unique_ptr<FrameSource> source = build_source(configuration, registry);
  PipelineBuilder builder = ConfigurationReader(configuration, registry).read(source->describe());
  return {std::move(source), ConfigurationReader::build_segmenter(std::move(builder))};
}

}  // namespace holdfast
