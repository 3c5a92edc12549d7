// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/run/configured_pipeline.hpp"

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
      {"surface", "A fused surface of the static scene, of what keyframes saw, and its mesh.",
       ParameterTable<SurfaceSettings>().parameters()},
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
  context.imu = configuration.imu;
  context.seed = configuration.run.seed;
  context.sequential = !configuration.run.threaded();
  return context;
}

PerturbationSettings perturbation_of(const Configuration& configuration) {
  return section_settings<PerturbationSettings>(configuration, "perturbation");
}

std::unique_ptr<FrameSource> make_source(const Configuration& configuration, const Registry& registry,
                                         const CreationContext& context) {
  auto source = registry.create<FrameSource>(configuration.source.name, configuration.source.values, context);
  const PerturbationSettings perturbation = perturbation_of(configuration);
  if (perturbation.is_nothing()) return source;
  const Camera camera = source->describe().camera.value_or(context.camera);
  return std::make_unique<PerturbedSource>(std::move(source), perturbation, camera, configuration.run.seed);
}

template <class Interface>
ModuleOf<Interface> module_of(const ModuleChoice& choice) {
  ModuleOf<Interface> module(choice.name, choice.values);
  module.place = choice.location;
  return module;
}

void choose_modules(const Configuration& configuration, PipelineBuilder& builder) {
  builder.features(module_of<FeatureExtractor>(configuration.features))
      .segmenter(module_of<Segmenter>(configuration.segmenter))
      .optimizer(module_of<Optimizer>(configuration.optimizer))
      .loop_detector(module_of<LoopDetector>(configuration.loop_detector));
  // The builder has this one, whether or not it is registered.
  if (configuration.matcher.name != "nearest") builder.matcher(module_of<FeatureMatcher>(configuration.matcher));
  for (const ModuleChoice& choice : configuration.filters) builder.filter(module_of<DynamicFilter>(choice));
  for (const ModuleChoice& choice : configuration.observers) builder.observer(module_of<Observer>(choice));
}

void choose_settings(const Configuration& configuration, PipelineBuilder& builder) {
  builder.tracking(section_settings<TrackingSettings>(configuration, "tracking"))
      .stereo(section_settings<StereoSettings>(configuration, "stereo"))
      .segmentation(section_settings<SegmentationSettings>(configuration, "segmentation"))
      .evidence(section_settings<EvidenceSettings>(configuration, "evidence"))
      .mapping(section_settings<MappingSettings>(configuration, "mapping"))
      .loop_closing(section_settings<LoopClosingSettings>(configuration, "loop_closing"))
      .dense_map(section_settings<DenseMapSettings>(configuration, "dense_map"))
      .surface(section_settings<SurfaceSettings>(configuration, "surface"))
      .run(configuration.run);
}

/// A builder with the choices of a configuration, each with its place in the file.
PipelineBuilder builder_of(const Configuration& configuration, const Registry& registry,
                           const SourceDescription& source, const std::string& map_file = {}) {
  PipelineOrigin origin{.place = {configuration.file},
                        .source_place = configuration.source.location,
                        .imu_place = configuration.imu_location,
                        .source_name = configuration.source.name,
                        .unknown_camera = configuration.unknown_camera,
                        .is_camera_judged = true};
  if (!map_file.empty()) origin.map_name = map_file;
  PipelineBuilder builder(registry);
  builder.source(source).origin(std::move(origin));
  if (configuration.camera)
    builder.camera(perturbed_camera(*configuration.camera, perturbation_of(configuration), configuration.run.seed));
  if (configuration.sensor) builder.sensor(*configuration.sensor);
  if (configuration.imu && !source.imu) builder.imu(*configuration.imu);
  choose_modules(configuration, builder);
  choose_settings(configuration, builder);
  return builder;
}

}  // namespace

BuiltPipeline build_pipeline(const Configuration& configuration, const Registry& registry,
                             const PipelineOptions& options) {
  HOLDFAST_CHECK(!options.localise_only || !options.map_file.empty(), "localising needs a map");
  CreationContext context = context_of_source(configuration);
  context.output_directory = options.output_directory;
  auto source = make_source(configuration, registry, context);
  PipelineBuilder builder = builder_of(configuration, registry, source->describe(), options.map_file.string());
  builder.output_directory(options.output_directory);
  if (options.localise_only)
    builder.localise_in(read_map(options.map_file));
  else if (!options.map_file.empty())
    builder.map(read_map(options.map_file));
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
  std::unique_ptr<Segmenter> segmenter = builder_of(configuration, registry, source->describe()).build_segmenter();
  return {std::move(source), std::move(segmenter)};
}

}  // namespace holdfast
