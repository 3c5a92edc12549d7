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

#include "holdfast/config/run_settings.hpp"
#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/pipeline/pipeline.hpp"
#include "holdfast/plugin/builtin.hpp"
#include "holdfast/plugin/registry.hpp"

namespace holdfast {

/// Selects a module by typed settings, registry name or instance:
///
///     OrbSettings{.count = 1500}                  settings of a built-in module (holdfast/settings/*.hpp)
///     "orb"  or  {"orb", {{"count", 1500}}}       name of a module in the registry, with parameters
///     std::make_unique<MyFilter>()                instance made by the caller; {..., "name"} names it in reports
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
  std::unique_ptr<Interface> object;  ///< nullptr: build() constructs the module by name
  SourceLocation place;               ///< location in the configuration, for messages
};

/// Source locations and names of the builder's inputs, for error messages. The default describes a C++ program.
struct PipelineOrigin {
  SourceLocation place{"PipelineBuilder"};  ///< of inputs without a location of their own, such as a configuration file
  SourceLocation source_place = place;      ///< of the source
  SourceLocation imu_place = place;         ///< of the calibration of the IMU
  std::string source_name;                  ///< empty if there is no source
  std::string map_name = "the map";         ///< of the map to continue or to localise in
  std::optional<Diagnostic> unknown_camera;  ///< Configuration::unknown_camera
  bool is_camera_judged = false;             ///< the configuration already contains the warnings about the camera
};

/// Builds a pipeline from C++:
///
///     Pipeline pipeline = PipelineBuilder()
///         .camera("tum_fr1")
///         .features(OrbSettings{.count = 1500})
///         .optimizer(CeresSettings{})
///         .filter(MultiViewDepthSettings{})
///         .build();
///
/// Camera, features and optimizer are required; every other part is optional, as in a configuration. The builder also
/// checks whether the modules are compatible with each other and with the source; configurations use it, too
/// (run/configured_pipeline.hpp). Modules are constructed and checked by build(), which reports all errors together. A
/// builder is used once, by one thread.
class PipelineBuilder {
 public:
  /// With the built-in modules. Requires the library holdfast::holdfast.
  PipelineBuilder() : PipelineBuilder(&register_builtin_plugins) {}
  /// With the modules of this registry.
  explicit PipelineBuilder(Registry registry);
  /// With the modules that this function registers.
  explicit PipelineBuilder(void (*register_modules)(Registry&));
  ~PipelineBuilder();
  PipelineBuilder(PipelineBuilder&&) noexcept;
  PipelineBuilder& operator=(PipelineBuilder&&) noexcept;

  /// Loads a shared plugin and registers its modules. Throws as load_plugin() does.
  PipelineBuilder& plugin(const std::string& name_or_path);
  /// Registers the modules of a linked plugin by its entry function.
  PipelineBuilder& plugin(void (*entry)(Registry&));

  PipelineBuilder& camera(const Camera& camera);
  /// Selects a known camera by name, see camera_names().
  PipelineBuilder& camera(const std::string& name);
  /// Sets the description of the frame source: camera, available images, and class names for the segmenter `truth`.
  PipelineBuilder& source(const SourceDescription& description);

  /// Sets the locations of the inputs in a configuration. Must be called after source(), whose name it replaces.
  PipelineBuilder& origin(PipelineOrigin origin);

  /// Selects the sensor mode. Default: RGB-D if the source has depth, else stereo if it has a right image, else
  /// monocular.
  PipelineBuilder& sensor(Sensor sensor);

  /// Sets the calibration of the IMU of SensorFrame::imu. Default: that of the source, if it has one.
  PipelineBuilder& imu(const ImuCalibration& calibration);

  PipelineBuilder& features(ModuleOf<FeatureExtractor> module);
  PipelineBuilder& optimizer(ModuleOf<Optimizer> module);
  PipelineBuilder& segmenter(ModuleOf<Segmenter> module);
  /// Selects the matcher. Default: `nearest`.
  PipelineBuilder& matcher(ModuleOf<FeatureMatcher> module);
  PipelineBuilder& loop_detector(ModuleOf<LoopDetector> module);
  /// Appends a filter to the chain.
  PipelineBuilder& filter(ModuleOf<DynamicFilter> module);
  PipelineBuilder& observer(ModuleOf<Observer> module);

  PipelineBuilder& tracking(const TrackingSettings& settings);
  PipelineBuilder& stereo(const StereoSettings& settings);
  /// Dense disparities of a pair by an algorithm of the caller, in place of StereoSettings::dense = sgbm.
  PipelineBuilder& dense_stereo(std::unique_ptr<DenseStereo> matcher);
  PipelineBuilder& segmentation(const SegmentationSettings& settings);
  PipelineBuilder& evidence(const EvidenceSettings& settings);
  PipelineBuilder& mapping(const MappingSettings& settings);
  PipelineBuilder& loop_closing(const LoopClosingSettings& settings);
  PipelineBuilder& dense_map(const DenseMapSettings& settings);
  PipelineBuilder& surface(const SurfaceSettings& settings);

  /// Threads, pace and seed; the default is sequential.
  PipelineBuilder& run(const RunSettings& settings);
  /// Changes only the seed of run().
  PipelineBuilder& seed(std::uint64_t seed);
  /// Sets the folder for modules that write files, such as the observer `overlay`.
  PipelineBuilder& output_directory(std::filesystem::path folder);
  /// Sets a map to continue, for instance from read_map(). Relocalisation in it requires a loop detector.
  PipelineBuilder& map(Map map);
  /// Sets a map for localisation, which is not changed. Requires a loop detector.
  PipelineBuilder& localise_in(Map map);

  /// Constructs the modules and the pipeline. Throws ConfigurationError with all errors found (unknown modules and
  /// parameters, values out of range, missing or incompatible modules), InputError for a map of another camera, and any
  /// exception of a module's constructor. Must be called once.
  Pipeline build();
  /// Constructs the segmenter only, with the same checks of its requirements.
  std::unique_ptr<Segmenter> build_segmenter();

 private:
  template <class Interface>
  std::unique_ptr<Interface> make(ModuleOf<Interface>& module);
  template <class Interface>
  std::unique_ptr<Interface> make_if_any(std::optional<ModuleOf<Interface>>& module);
  template <class Settings>
  void check(const Settings& settings, const char* section);
  void check_camera();
  void judge_camera();
  void check_settings();
  void make_modules();
  void throw_diagnostics();
  void choose_sensor();
  std::string reason_of_no_depth() const;
  void check_filter(const ModuleOf<DynamicFilter>& module, const Needs& needs);
  void check_classes(const ModuleOf<DynamicFilter>& module, const DynamicFilter& filter);
  void check_class(const SourceLocation& place, const std::string& name, const std::string& use,
                   const std::string& remedy);
  void check_class_weights();
  void check_effects();
  bool follows_another_filter(std::size_t index) const;
  void check_map() const;
  void check_places() const;
  void check_imu();
  void check_factors();
  void add_diagnostic(const SourceLocation& place, std::string message);
  /// Adds a warning (core/warning.hpp) to those of the pipeline.
  void suspect(const SourceLocation& place, std::string message);

  Registry registry_;
  PipelineParts parts_;
  CreationContext context_;
  std::optional<Camera> source_camera_;
  bool has_camera_ = false;
  bool has_global_shutter_ = false;
  bool has_depth_ = true;
  bool has_right_ = false;
  bool has_imu_ = false;
  std::optional<Sensor> sensor_;
  bool has_map_ = false;
  PipelineOrigin origin_;
  std::vector<Diagnostic> diagnostics_;
  std::optional<ModuleOf<FeatureExtractor>> features_;
  std::optional<ModuleOf<Optimizer>> optimizer_;
  std::optional<ModuleOf<Segmenter>> segmenter_;
  std::optional<ModuleOf<FeatureMatcher>> matcher_;
  std::optional<ModuleOf<LoopDetector>> loop_detector_;
  std::vector<ModuleOf<DynamicFilter>> filters_;
  std::vector<ModuleOf<Observer>> observers_;
};

}  // namespace holdfast
