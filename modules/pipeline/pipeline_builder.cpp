// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/pipeline/pipeline_builder.hpp"

#include <algorithm>

#include "camera_numbers.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/plugin/did_you_mean.hpp"
#include "holdfast/plugin/loader.hpp"
#include "holdfast/plugin/module_check.hpp"
#include "holdfast/plugin/parameter_check.hpp"
#include "holdfast/surface/surface_field.hpp"

namespace holdfast {

namespace {

template <class Interface>
bool is_absent(const std::optional<ModuleOf<Interface>>& module) {
  return !module || (module->object == nullptr && module->name == "none");
}

}  // namespace

PipelineBuilder::PipelineBuilder(Registry registry) : registry_(std::move(registry)) {}
PipelineBuilder::PipelineBuilder(void (*register_modules)(Registry&)) { register_modules(registry_); }
PipelineBuilder::~PipelineBuilder() = default;
PipelineBuilder::PipelineBuilder(PipelineBuilder&&) noexcept = default;
PipelineBuilder& PipelineBuilder::operator=(PipelineBuilder&&) noexcept = default;

PipelineBuilder& PipelineBuilder::plugin(const std::string& name_or_path) {
  load_plugin(registry_, name_or_path);
  return *this;
}
PipelineBuilder& PipelineBuilder::plugin(void (*entry)(Registry&)) {
  entry(registry_);
  return *this;
}

PipelineBuilder& PipelineBuilder::camera(const Camera& camera) {
  parts_.camera = camera;
  has_camera_ = true;
  return *this;
}
PipelineBuilder& PipelineBuilder::camera(const std::string& name) {
  if (const std::optional<Camera> known = find_camera(name)) return camera(*known);
  add_diagnostic(origin_.place, "camera '" + name + "' is unknown; " + did_you_mean(name, camera_names()));
  return camera(Camera{});
}
PipelineBuilder& PipelineBuilder::source(const SourceDescription& description) {
  source_camera_ = description.camera;
  origin_.source_name = description.name;
  has_depth_ = description.has_depth;
  has_right_ = description.has_right;
  has_imu_ = description.has_imu;
  if (description.imu) parts_.imu = description.imu;
  parts_.checks_imu = !description.imu;  // a source that has applied the calibration judges the measurements itself
  has_global_shutter_ = description.has_global_shutter;
  context_.class_names = description.class_names;
  context_.frame_timestamps = description.frame_timestamps;
  return *this;
}

PipelineBuilder& PipelineBuilder::origin(PipelineOrigin origin) {
  origin_ = std::move(origin);
  return *this;
}

PipelineBuilder& PipelineBuilder::sensor(Sensor sensor) {
  sensor_ = sensor;
  return *this;
}

PipelineBuilder& PipelineBuilder::imu(const ImuCalibration& calibration) {
  parts_.imu = calibration;
  return *this;
}

PipelineBuilder& PipelineBuilder::features(ModuleOf<FeatureExtractor> module) {
  features_ = std::move(module);
  return *this;
}
PipelineBuilder& PipelineBuilder::optimizer(ModuleOf<Optimizer> module) {
  optimizer_ = std::move(module);
  return *this;
}
PipelineBuilder& PipelineBuilder::segmenter(ModuleOf<Segmenter> module) {
  segmenter_ = std::move(module);
  return *this;
}
PipelineBuilder& PipelineBuilder::matcher(ModuleOf<FeatureMatcher> module) {
  matcher_ = std::move(module);
  return *this;
}
PipelineBuilder& PipelineBuilder::loop_detector(ModuleOf<LoopDetector> module) {
  loop_detector_ = std::move(module);
  return *this;
}
PipelineBuilder& PipelineBuilder::filter(ModuleOf<DynamicFilter> module) {
  filters_.push_back(std::move(module));
  return *this;
}
PipelineBuilder& PipelineBuilder::observer(ModuleOf<Observer> module) {
  observers_.push_back(std::move(module));
  return *this;
}

PipelineBuilder& PipelineBuilder::tracking(const TrackingSettings& settings) {
  parts_.tracking = settings;
  return *this;
}
PipelineBuilder& PipelineBuilder::stereo(const StereoSettings& settings) {
  parts_.stereo = settings;
  return *this;
}
PipelineBuilder& PipelineBuilder::dense_stereo(std::unique_ptr<DenseStereo> matcher) {
  parts_.dense_stereo = std::move(matcher);
  return *this;
}
PipelineBuilder& PipelineBuilder::segmentation(const SegmentationSettings& settings) {
  parts_.segmentation = settings;
  return *this;
}
PipelineBuilder& PipelineBuilder::evidence(const EvidenceSettings& settings) {
  parts_.evidence = settings;
  return *this;
}
PipelineBuilder& PipelineBuilder::mapping(const MappingSettings& settings) {
  parts_.mapping = settings;
  return *this;
}
PipelineBuilder& PipelineBuilder::loop_closing(const LoopClosingSettings& settings) {
  parts_.loop_closing = settings;
  return *this;
}
PipelineBuilder& PipelineBuilder::dense_map(const DenseMapSettings& settings) {
  parts_.dense_map = settings;
  return *this;
}
PipelineBuilder& PipelineBuilder::surface(const SurfaceSettings& settings) {
  parts_.surface = settings;
  return *this;
}

PipelineBuilder& PipelineBuilder::run(const RunSettings& settings) {
  parts_.run = settings;
  context_.sequential = !settings.threaded();
  return seed(settings.seed);
}
PipelineBuilder& PipelineBuilder::seed(std::uint64_t seed) {
  parts_.run.seed = context_.seed = seed;
  return *this;
}
PipelineBuilder& PipelineBuilder::output_directory(std::filesystem::path folder) {
  context_.output_directory = std::move(folder);
  return *this;
}
PipelineBuilder& PipelineBuilder::map(Map map) {
  parts_.map = std::move(map);
  has_map_ = true;
  return *this;
}
PipelineBuilder& PipelineBuilder::localise_in(Map map) {
  parts_.localise_only = true;
  return this->map(std::move(map));
}

void PipelineBuilder::add_diagnostic(const SourceLocation& place, std::string message) {
  diagnostics_.push_back({place.file.empty() ? origin_.place : place, std::move(message)});
}

void PipelineBuilder::suspect(const SourceLocation& place, std::string message) {
  add_warning(parts_.warnings, {place.file.empty() ? origin_.place : place, std::move(message)});
}

template <class Interface>
std::unique_ptr<Interface> PipelineBuilder::make(ModuleOf<Interface>& module) {
  if (module.object) return std::move(module.object);
  const SourceLocation& place = module.place.file.empty() ? origin_.place : module.place;
  const ModuleEntry* entry = find_module(registry_, Interface::kind, module.name, place, diagnostics_);
  if (entry == nullptr) return nullptr;
  const std::size_t before = diagnostics_.size();
  const ParameterValues values = check_parameters(
      module.values, entry->parameters, std::string(Interface::kind) + " '" + module.name + "'", place, diagnostics_);
  if (diagnostics_.size() > before) return nullptr;
  return registry_.create<Interface>(module.name, values, context_);
}

template <class Interface>
std::unique_ptr<Interface> PipelineBuilder::make_if_any(std::optional<ModuleOf<Interface>>& module) {
  return module ? make(*module) : nullptr;
}

template <class Settings>
void PipelineBuilder::check(const Settings& settings, const char* section) {
  const ParameterTable<Settings> table;
  check_parameters(table.values(settings), table.parameters(), section, origin_.place, diagnostics_);
}

void PipelineBuilder::check_camera() {
  const Sensor offered = has_depth_ ? Sensor::rgbd : has_right_ ? Sensor::stereo : Sensor::mono;
  parts_.sensor = sensor_.value_or(offered);
  context_.sensor = parts_.sensor;
  // The baseline of a real pair is the source's; that of the configured camera is of a virtual one.
  if (source_camera_ && parts_.sensor != Sensor::rgbd) parts_.camera.baseline = source_camera_->baseline;
  if (source_camera_ && has_camera_ && !origin_.unknown_camera && have_other_numbers(*source_camera_, parts_.camera))
    add_diagnostic(origin_.source_place,
                   "the source '" + origin_.source_name +
                       "' brings its own camera, and 'camera' names one with other numbers; remove one of "
                       "them");
  if (source_camera_) parts_.camera = *source_camera_;
  if (has_global_shutter_) {
    parts_.camera.readout = 0.0;
    parts_.tracking.rolling_shutter = RollingShutterMode::off;
  }
  // Without a pair, the baseline only says what counts as near, in the map's own unit.
  if (parts_.sensor == Sensor::mono) parts_.camera.baseline = Camera().baseline;
  if (!source_camera_ && !has_camera_ && origin_.unknown_camera)
    add_diagnostic(origin_.unknown_camera->location, origin_.unknown_camera->message);
  else if (!source_camera_ && !has_camera_) {
    std::string known;
    for (const std::string& name : camera_names()) known += (known.empty() ? "" : ", ") + name;
    const std::string source =
        origin_.source_name.empty() ? "" : ", and the source '" + origin_.source_name + "' does not know its own";
    add_diagnostic(origin_.place,
                   "the camera is missing" + source + "; expected 'camera' with a name (" + known + ") or numbers");
  }
  judge_camera();
  context_.camera = parts_.camera;
}

void PipelineBuilder::judge_camera() {
  const SourceLocation& place = source_camera_ ? origin_.source_place : origin_.place;
  const std::string whose = source_camera_ ? "of the camera that the source '" + origin_.source_name + "' gives, " : "";
  if (const std::string trouble = parts_.camera.trouble(); !trouble.empty()) {
    add_diagnostic(place, whose + trouble);
    return;
  }
  if (!source_camera_ && origin_.is_camera_judged) return;
  for (const std::string& suspicion : parts_.camera.suspicions(parts_.sensor != Sensor::mono))
    suspect(place, whose + suspicion);
}

void PipelineBuilder::check_imu() {
  context_.imu = parts_.imu;
  if (!parts_.imu) return;
  if (const std::string trouble = parts_.imu->trouble(); !trouble.empty())
    add_diagnostic(origin_.imu_place, "the calibration of the IMU: " + trouble);
  if (!origin_.source_name.empty() && !has_imu_)
    suspect(origin_.imu_place, "'imu' has no effect, because the source '" + origin_.source_name +
                                   "' gives no inertial measurements; name their file in the source, where it has the "
                                   "parameter `imu`, or remove the section");
}

void PipelineBuilder::check_settings() {
  check(parts_.tracking, "tracking");
  check(parts_.stereo, "stereo");
  check(parts_.segmentation, "segmentation");
  check(parts_.evidence, "evidence");
  check(parts_.mapping, "mapping");
  check(parts_.loop_closing, "loop_closing");
  check(parts_.dense_map, "dense_map");
  check(parts_.surface, "surface");
  if (const std::string trouble = parts_.surface.trouble(); !trouble.empty()) add_diagnostic(origin_.place, trouble);
  if (parts_.surface.enabled && !SurfaceField::is_available())
    add_diagnostic(
        origin_.place,
        "surface.enabled is true, and this build has no OpenVDB, which surfaces need; install it (`sh "
        "cmake/install_dependencies.sh --surface`), configure and build again, or use `dense_map: { enabled: "
        "true }` for a coloured cloud");
  check(parts_.run, "run");
  if (const auto reason = parts_.run.contradiction()) add_diagnostic(origin_.place, *reason);
}

std::string PipelineBuilder::reason_of_no_depth() const {
  return parts_.sensor == Sensor::stereo ? "stereo.dense is 'off'"
                                         : "the sensor is '" + std::string(sensor_name(parts_.sensor)) + "'";
}

void PipelineBuilder::check_filter(const ModuleOf<DynamicFilter>& module, const Needs& needs) {
  if (needs.depth && !parts_.has_dense_depth())
    add_diagnostic(module.place, "the filter '" + module.name + "' needs depth, and " + reason_of_no_depth() +
                                     "; remove it, or choose one that does without, such as 'epipolar_consistency'");
  if (needs.segmentation && is_absent(segmenter_))
    add_diagnostic(module.place, "the filter '" + module.name +
                                     "' needs a segmentation, but the segmenter is 'none'; choose a segmenter");
}

void PipelineBuilder::check_class(const SourceLocation& place, const std::string& name, const std::string& use,
                                  const std::string& remedy) {
  if (is_absent(segmenter_) || !parts_.segmenter) return;
  const std::vector<std::string>& known = parts_.segmenter->classes();
  if (std::find(known.begin(), known.end(), name) != known.end()) return;
  add_diagnostic(place, use + ", and the segmenter '" + segmenter_->name + "' has no such class; " + remedy +
                            did_you_mean(name, known));
}

void PipelineBuilder::check_classes(const ModuleOf<DynamicFilter>& module, const DynamicFilter& filter) {
  if (!parts_.segmenter) return;
  const std::vector<std::string> named = filter.named_classes();
  for (const std::string& name : filter.movable_classes(parts_.segmenter->movable()))
    if (std::find(named.begin(), named.end(), name) == named.end())
      check_class(module.place, name, "the filter '" + module.name + "' counts the class '" + name + "' as movable",
                  "expected one of its classes in `classes` of the filter; ");
  for (const std::string& name : named)
    check_class(module.place, name, "the filter '" + module.name + "' names the class '" + name + "'",
                "expected one of its classes in `movable` of the filter; ");
}

void PipelineBuilder::check_class_weights() {
  if (!parts_.loop_detector) return;
  const auto weights = parts_.loop_detector->class_weights();
  const std::string detector = "the loop detector '" + loop_detector_->name + "'";
  if (!weights.empty() && is_absent(segmenter_))
    add_diagnostic(loop_detector_->place, detector +
                                              " weights classes, and the segmenter is 'none'; choose a segmenter, "
                                              "or remove `class_weights`");
  for (const auto& [name, weight] : weights)
    check_class(loop_detector_->place, name, detector + " weights the class '" + name + "'",
                "expected its classes in `class_weights`; ");
}

/// A map can only be continued by the camera that made it, because bundle adjustment knows one camera, and by the
/// extractor that made it, because others find other corners.
void PipelineBuilder::check_map() const {
  if (parts_.map.keyframes().empty())
    throw InputError({origin_.map_name}, "is a map without keyframes; expected one that a run has saved");
  if (parts_.map.sensor() != parts_.sensor)
    throw InputError({origin_.map_name},
                     std::string("was made with the sensor '") + sensor_name(parts_.map.sensor()) +
                         "', and the run has '" + sensor_name(parts_.sensor) +
                         "'; expected the same sensor, because keyframes of another one fit neither its "
                         "scale nor its adjustment");
  const MapFeatures& there = parts_.map.features();
  const DescriptorType here = parts_.features->descriptor_type();
  const bool has_other_name =
      !there.extractor.empty() && !parts_.features_name.empty() && there.extractor != parts_.features_name;
  if (has_other_name || !there.descriptors.is_comparable(here)) {
    const auto named = [](const std::string& name, const DescriptorType& type) {
      return "'" + (name.empty() ? std::string("an extractor without a name") : name) + "' with descriptors of " +
             to_string(type);
    };
    throw InputError({origin_.map_name},
                     "was made with the features " + named(there.extractor, there.descriptors) + ", and the run has " +
                         named(parts_.features_name, here) +
                         "; expected the same extractor, because features of another one cannot be matched");
  }
  check_places();
  parts_.map.keyframes().for_each([&](KeyFrameId, const KeyFrame& keyframe) {
    if (have_other_numbers(*keyframe.frame.camera, parts_.camera))
      throw InputError({origin_.map_name}, "was made with the camera '" + keyframe.frame.camera->name +
                                               "', and the run has '" + parts_.camera.name +
                                               "' with other numbers; expected the same camera");
  });
}

/// A detector that compares images needs those of the map, as its own network describes them.
void PipelineBuilder::check_places() const {
  const std::optional<DescriptorType> needed = parts_.loop_detector->image_descriptor();
  if (!needed) return;
  bool has_places = false;
  parts_.map.keyframes().for_each([&](KeyFrameId, const KeyFrame& keyframe) {
    const DescriptorBlock& place = keyframe.frame.image_descriptor;
    if (place.empty()) return;
    has_places = true;
    if (!place.type().is_comparable(*needed))
      throw InputError({origin_.map_name}, "holds descriptions of its keyframes' images by " + to_string(place.type()) +
                                               ", and the loop detector '" + loop_detector_->name + "' makes " +
                                               to_string(*needed) +
                                               "; expected the loop detector with the network that made the map");
  });
  if (!has_places)
    throw InputError({origin_.map_name},
                     "holds no descriptions of its keyframes' images, which the loop detector '" +
                         loop_detector_->name +
                         "' compares; expected a map that a run with this detector made, or another "
                         "detector, such as 'loop_detector: { flann: {} }'");
}

void PipelineBuilder::choose_sensor() {
  const bool lacks_depth = parts_.sensor == Sensor::rgbd && !has_depth_;
  const bool lacks_right = parts_.sensor == Sensor::stereo && !has_right_;
  if (lacks_depth || lacks_right)
    add_diagnostic(origin_.source_place, "the sensor is '" + std::string(sensor_name(parts_.sensor)) +
                                             "', and the source '" + origin_.source_name + "' has no " +
                                             (lacks_depth ? "depth" : "right") +
                                             " images; expected another source, or another 'sensor'");
  for (const auto& [section, is_enabled] : {std::pair{std::string("dense_map"), parts_.dense_map.enabled},
                                            std::pair{std::string("surface"), parts_.surface.enabled}})
    if (is_enabled && !parts_.has_dense_depth())
      add_diagnostic(origin_.place,
                     section + " needs depth images, and " + reason_of_no_depth() + "; remove `" + section + "`");
  if (parts_.sensor != Sensor::stereo) return;
  if (parts_.tracking.between_keyframes == BetweenKeyframes::flow)
    add_diagnostic(origin_.place,
                   "tracking.between_keyframes is 'flow', which does not follow features in the right image of a "
                   "stereo pair; expected 'features'");
  if (!parts_.camera.distortion.is_zero())
    add_diagnostic(origin_.place,
                   "the camera of a stereo pair has distortion; expected rectified images, whose camera has none");
  // An extractor that was given as an object exists once: it finds the features of one image after the other.
  if (!features_ || features_->object) return;
  ModuleOf<FeatureExtractor> right(features_->name, features_->values);
  right.place = features_->place;
  parts_.right_features = make(right);
}

void PipelineBuilder::make_modules() {
  if (features_) parts_.features_name = features_->name;
  parts_.features = make_if_any(features_);
  parts_.matcher = make_if_any(matcher_);
  if (parts_.features && parts_.matcher) {
    const std::string trouble = parts_.matcher->incompatibility(parts_.features->descriptor_type());
    if (!trouble.empty())
      add_diagnostic(matcher_->place, "the matcher '" + matcher_->name + "'" + " " + trouble + ", and " +
                                          "the extractor '" + parts_.features_name + "'" + " has " +
                                          to_string(parts_.features->descriptor_type()) +
                                          "; choose other features, or another matcher");
  }
  parts_.segmenter = make_if_any(segmenter_);
  parts_.optimizer = make_if_any(optimizer_);
  check_factors();
  parts_.loop_detector = make_if_any(loop_detector_);
  for (ModuleOf<DynamicFilter>& module : filters_) {
    std::unique_ptr<DynamicFilter> filter = make(module);
    if (filter) {
      check_filter(module, filter->needs());
      check_classes(module, *filter);
    }
    parts_.filters.emplace_back(module.name, std::move(filter));
  }
  check_class_weights();
  for (ModuleOf<Observer>& module : observers_) parts_.observers.push_back(make(module));
}

/// Adjustments with inertial measurements need an optimizer for them.
void PipelineBuilder::check_factors() {
  if (!parts_.optimizer || !parts_.imu || !parts_.tracking.inertia || !parts_.mapping.inertia) return;
  if (parts_.localise_only) return;  // the map stays as it is
  if (parts_.optimizer->supports(FactorKind::inertial) && parts_.optimizer->supports(FactorKind::prior)) return;
  add_diagnostic(optimizer_->place,
                 "'mapping.inertia' needs an optimizer that solves problems with inertial factors, "
                 "and '" +
                     optimizer_->name +
                     "' does not; choose 'ceres' or 'schur', or set "
                     "mapping.inertia: false");
}

void PipelineBuilder::throw_diagnostics() {
  if (!diagnostics_.empty()) throw ConfigurationError(std::move(diagnostics_));
}

Pipeline PipelineBuilder::build() {
  check_camera();
  if (!features_) add_diagnostic(origin_.place, "features() is missing; choose an extractor, such as 'orb'");
  if (!optimizer_) add_diagnostic(origin_.place, "optimizer() is missing; choose one, such as 'ceres'");
  check_imu();
  check_settings();
  choose_sensor();
  make_modules();
  if (has_map_ && is_absent(loop_detector_))
    add_diagnostic(
        loop_detector_ ? loop_detector_->place : origin_.place,
        "a camera in a loaded map finds its place by place recognition, but the loop detector is 'none'; choose "
        "one, such as 'loop_detector: { flann: {} }'");
  throw_diagnostics();
  check_effects();
  if (has_map_) check_map();
  return Pipeline(std::move(parts_));
}

std::unique_ptr<Segmenter> PipelineBuilder::build_segmenter() {
  check_camera();
  if (is_absent(segmenter_))
    add_diagnostic(segmenter_ ? segmenter_->place : origin_.place,
                   "the segmenter is 'none', which finds nothing; choose one under 'segmenter:', such as 'onnx'");
  std::unique_ptr<Segmenter> segmenter = make_if_any(segmenter_);
  throw_diagnostics();
  return segmenter;
}

}  // namespace holdfast
