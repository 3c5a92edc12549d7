// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/pipeline/pipeline_builder.hpp"

#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/map_io/map_file.hpp"

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

template <class Settings>
Settings section(const Configuration& configuration, const std::string& name) {
  const auto found = configuration.sections.find(name);
  return found == configuration.sections.end() ? Settings{} : ParameterTable<Settings>().settings(found->second);
}

bool differ(Camera a, const Camera& b) {
  a.name = b.name;  // only the numbers matter
  return a != b;
}

/// The camera of the run: the configuration's or the source's; when both name one, they must agree.
Camera resolve_camera(const Configuration& configuration, const SourceDescription& source,
                      std::vector<Diagnostic>& diagnostics) {
  if (source.camera && configuration.camera && differ(*source.camera, *configuration.camera))
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

void check_needs(const ModuleChoice& choice, const Needs& needs, const SourceDescription& source,
                 const Configuration& configuration, std::vector<Diagnostic>& diagnostics) {
  if (needs.depth && !source.has_depth)
    diagnostics.push_back({choice.location, "the filter '" + choice.name + "' needs depth, which the source '" +
                                                configuration.source.name + "' does not have; remove one of them"});
  if (needs.segmentation && configuration.segmenter.name == "none")
    diagnostics.push_back(
        {choice.location,
         "the filter '" + choice.name + "' needs a segmentation, but the segmenter is 'none'; choose a segmenter"});
}

/// A map can only be continued by the camera that made it: bundle adjustment knows one camera.
void check_map(const Map& map, const Camera& camera, const std::filesystem::path& file) {
  if (map.keyframes().empty())
    throw InputError({file.string()}, "is a map without keyframes; expected one that a run has saved");
  map.keyframes().for_each([&](KeyFrameId, const KeyFrame& keyframe) {
    if (differ(*keyframe.frame.camera, camera))
      throw InputError({file.string()}, "was made with the camera '" + keyframe.frame.camera->name +
                                            "', and the run has '" + camera.name +
                                            "' with other numbers; expected the same camera");
  });
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

BuiltPipeline build_pipeline(const Configuration& configuration, const Registry& registry, const RunOptions& options) {
  CreationContext context = context_of_source(configuration);
  context.output_directory = options.output_directory;
  const auto create = [&]<class Interface>(const ModuleChoice& choice) {
    return registry.create<Interface>(choice.name, choice.values, context);
  };

  std::unique_ptr<FrameSource> source = create.operator()<FrameSource>(configuration.source);
  const SourceDescription description = source->describe();
  std::vector<Diagnostic> diagnostics;
  context.camera = resolve_camera(configuration, description, diagnostics);
  context.class_names = description.class_names;

  PipelineParts parts;
  parts.camera = context.camera;
  parts.seed = context.seed;
  parts.features = create.operator()<FeatureExtractor>(configuration.features);
  parts.segmenter = create.operator()<Segmenter>(configuration.segmenter);
  parts.optimizer = create.operator()<Optimizer>(configuration.optimizer);
  parts.loop_detector = create.operator()<LoopDetector>(configuration.loop_detector);
  for (const ModuleChoice& choice : configuration.filters) {
    auto filter = create.operator()<DynamicFilter>(choice);
    check_needs(choice, filter->needs(), description, configuration, diagnostics);
    parts.filters.emplace_back(choice.name, std::move(filter));
  }
  for (const ModuleChoice& choice : configuration.observers)
    parts.observers.push_back(create.operator()<Observer>(choice));
  parts.tracking = section<TrackingSettings>(configuration, "tracking");
  parts.segmentation = section<SegmentationSettings>(configuration, "segmentation");
  parts.evidence = section<EvidenceSettings>(configuration, "evidence");
  parts.mapping = section<MappingSettings>(configuration, "mapping");
  parts.loop_closing = section<LoopClosingSettings>(configuration, "loop_closing");
  parts.dense_map = section<DenseMapSettings>(configuration, "dense_map");
  parts.threads.threaded = !context.sequential;
  parts.threads.keyframe_queue = static_cast<std::size_t>(configuration.run.keyframe_queue);
  parts.threads.unpaced = configuration.run.pace == "none";
  if (!description.has_depth)
    diagnostics.push_back(
        {configuration.source.location,
         "the source '" + configuration.source.name + "' has no depth; this version tracks colour with depth only"});
  if (!options.map_file.empty() && configuration.loop_detector.name == "none")
    diagnostics.push_back({configuration.loop_detector.location,
                           "a camera in a loaded map finds its place by place recognition, but the loop detector is "
                           "'none'; choose one, such as 'loop_detector: { flann: {} }'"});
  if (!diagnostics.empty()) throw ConfigurationError(std::move(diagnostics));
  parts.localise_only = options.localise_only;
  HOLDFAST_CHECK(!options.localise_only || !options.map_file.empty(), "localising needs a map");
  if (!options.map_file.empty()) {
    read_map(options.map_file, parts.map);
    check_map(parts.map, parts.camera, options.map_file);
  }
  return {std::move(source), Pipeline(std::move(parts))};
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
