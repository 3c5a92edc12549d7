// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "holdfast/config/configuration.hpp"
#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/pipeline/pipeline.hpp"
#include "holdfast/plugin/builtin.hpp"
#include "holdfast/plugin/registry.hpp"

namespace holdfast {

/// What a PipelineBuilder takes for a part, however it is said:
///
///     OrbSettings{.count = 1500}                  settings of a built-in module (holdfast/settings/*.hpp)
///     "orb"  or  {"orb", {{"count", 1500}}}       a module of the registry, by name, with parameters
///     std::make_unique<MyFilter>()                an object of the caller's; {..., "name"} names it in reports
template <class Interface>
class ModuleOf {
 public:
  template <class Settings>
  requires std::same_as<typename Settings::Interface, Interface> ModuleOf(
      const Settings& settings)  // NOLINT(google-explicit-constructor): that is its purpose
      : name(Settings::module), values(ParameterTable<Settings>().values(settings)) {}
  ModuleOf(std::string module, ParameterValues parameters = {})  // NOLINT(google-explicit-constructor)
      : name(std::move(module)), values(std::move(parameters)) {}
  ModuleOf(const char* module) : name(module) {}  // NOLINT(google-explicit-constructor)
  template <class Made>
  requires std::derived_from<Made, Interface> ModuleOf(
      std::unique_ptr<Made> made, std::string name_of_it = "own")  // NOLINT(google-explicit-constructor)
      : name(std::move(name_of_it)), object(std::move(made)) {
    HOLDFAST_CHECK(object != nullptr, Interface::kind << ": an empty pointer");
  }

  std::string name;
  ParameterValues values;
  std::unique_ptr<Interface> object;  ///< nullptr: made by name when the pipeline is built
  SourceLocation place;               ///< of the choice, for messages
};

/// Makes a pipeline without a configuration file:
///
///     Pipeline pipeline = PipelineBuilder()
///         .camera("tum_fr1")
///         .features(OrbSettings{.count = 1500})
///         .optimizer(CeresSettings{})
///         .filter(MultiViewDepthSettings{})
///         .build();
///
/// Camera, features and optimizer are required; what else is not said is absent, as in a configuration. Nothing is made
/// or checked before build(), which tells everything that is wrong at once. Used once, by one thread.
class PipelineBuilder {
 public:
  /// Knows the built-in modules; link holdfast::holdfast.
  PipelineBuilder() { register_builtin_plugins(registry_); }
  /// Knows the modules of this registry.
  explicit PipelineBuilder(Registry registry) : registry_(std::move(registry)) {}

  /// Loads a shared plugin, so that its modules can be named. Throws as load_plugin() does.
  PipelineBuilder& plugin(const std::string& name_or_path);
  /// Calls the entry function of a plugin that is linked in, so that its modules can be named.
  PipelineBuilder& plugin(void (*entry)(Registry&));

  PipelineBuilder& camera(const Camera& camera);
  /// A known name, see camera_names().
  PipelineBuilder& camera(const std::string& name);
  /// What a frame source says of itself: its camera, and the names of its classes for the segmenter `truth`.
  PipelineBuilder& source(const SourceDescription& description);

  PipelineBuilder& features(ModuleOf<FeatureExtractor> module);
  PipelineBuilder& optimizer(ModuleOf<Optimizer> module);
  PipelineBuilder& segmenter(ModuleOf<Segmenter> module);
  PipelineBuilder& loop_detector(ModuleOf<LoopDetector> module);
  /// Adds to the chain, in the order of the calls.
  PipelineBuilder& filter(ModuleOf<DynamicFilter> module);
  PipelineBuilder& observer(ModuleOf<Observer> module);

  PipelineBuilder& tracking(const TrackingSettings& settings);
  PipelineBuilder& segmentation(const SegmentationSettings& settings);
  PipelineBuilder& evidence(const EvidenceSettings& settings);
  PipelineBuilder& mapping(const MappingSettings& settings);
  PipelineBuilder& loop_closing(const LoopClosingSettings& settings);
  PipelineBuilder& dense_map(const DenseMapSettings& settings);

  PipelineBuilder& seed(std::uint64_t seed);
  /// Sequential unless said otherwise.
  PipelineBuilder& threads(const ThreadSettings& settings);
  /// Told to the modules that write files, such as the observer `overlay`.
  PipelineBuilder& output_directory(std::filesystem::path folder);
  /// A map to continue, such as read_map() gives. It needs a loop detector, by which the camera finds its place.
  PipelineBuilder& map(Map map);
  /// The same, but the map stays as it is, and only poses are found.
  PipelineBuilder& localise_in(Map map);

  /// Makes the modules and the pipeline. Throws ConfigurationError with everything that is wrong (unknown modules and
  /// parameters, values out of range, parts that are missing or do not fit), InputError for a map of another camera,
  /// and what a module throws when it is made. Call it once.
  Pipeline build();

 private:
  friend class ConfigurationReader;  // says where in a file each choice stands

  template <class Interface>
  std::unique_ptr<Interface> make(ModuleOf<Interface>& module);
  template <class Interface>
  std::unique_ptr<Interface> make_if_any(std::optional<ModuleOf<Interface>>& module);
  template <class Settings>
  void check(const Settings& settings, const char* section);
  void check_camera();
  void check_filter(const ModuleOf<DynamicFilter>& module, const Needs& needs);
  void check_map() const;
  void complain(const SourceLocation& place, std::string message);

  Registry registry_;
  PipelineParts parts_;
  CreationContext context_;
  std::optional<Camera> source_camera_;
  bool has_camera_ = false;
  bool has_depth_ = true;
  bool has_map_ = false;
  std::string map_name_ = "the map";
  std::string source_name_ = "source";
  SourceLocation place_{"PipelineBuilder"}, source_place_ = place_;  // for what has no place of its own
  std::vector<Diagnostic> diagnostics_;
  std::optional<ModuleOf<FeatureExtractor>> features_;
  std::optional<ModuleOf<Optimizer>> optimizer_;
  std::optional<ModuleOf<Segmenter>> segmenter_;
  std::optional<ModuleOf<LoopDetector>> loop_detector_;
  std::vector<ModuleOf<DynamicFilter>> filters_;
  std::vector<ModuleOf<Observer>> observers_;
};

/// The plain sections of a configuration that belong to the pipeline: tracking, mapping, loop_closing. For
/// load_configuration().
std::vector<SectionDescription> pipeline_sections();

/// A source and the pipeline that its frames go into.
struct BuiltPipeline {
  std::unique_ptr<FrameSource> source;
  Pipeline pipeline;
};

/// What a run starts from and leaves behind, beside its configuration.
struct RunOptions {
  std::filesystem::path output_directory;  ///< told to the modules; empty when nothing is written
  std::filesystem::path map_file;          ///< a map to continue, or to localise in; empty = begin a new one
  bool localise_only = false;              ///< find poses in the map and leave it as it is; needs map_file
};

/// Makes every module that a configuration chose and checks that they fit together: the camera is known and not
/// told twice differently, filters get what they need, a map was made with the same camera and places in it can be
/// recognised. Throws ConfigurationError with all misfits, InputError for a map file that cannot be used, and what a
/// module throws when it is made. The registry is not needed afterwards.
BuiltPipeline build_pipeline(const Configuration& configuration, const Registry& registry,
                             const RunOptions& options = {});

/// A source and the segmenter that its frames are given to.
struct BuiltSegmenter {
  std::unique_ptr<FrameSource> source;
  std::unique_ptr<Segmenter> segmenter;
};

/// Makes only these two of what a configuration chose: for `holdfast segment`. Throws as build_pipeline() does, and
/// ConfigurationError when the segmenter is 'none'.
BuiltSegmenter build_segmenter(const Configuration& configuration, const Registry& registry);

}  // namespace holdfast
