// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/config/configuration.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "holdfast/config/parameter_reader.hpp"
#include "holdfast/core/folder_name.hpp"
#include "holdfast/plugin/did_you_mean.hpp"
#include "holdfast/plugin/loader.hpp"
#include "holdfast/plugin/module_check.hpp"
#include "parameter_places.hpp"
#include "renamed_keys.hpp"

namespace holdfast {

void CameraSettings::describe(ParameterTable<CameraSettings>& table) {
  using S = CameraSettings;
  table.add("name", &S::name, "of a known camera, whose numbers count where none are given; empty = none");
  table.add("width", &S::width, "columns of the images").range(1, 32768).unit("px").required();
  table.add("height", &S::height, "rows of the images").range(1, 32768).unit("px").required();
  table.add("fx", &S::fx, "focal length along x").range(1, 1e6).unit("px").required();
  table.add("fy", &S::fy, "focal length along y").range(1, 1e6).unit("px").required();
  table.add("cx", &S::cx, "column of the optical axis").range(-1e6, 1e6).unit("px").required();
  table.add("cy", &S::cy, "row of the optical axis").range(-1e6, 1e6).unit("px").required();
  table.add("k1", &S::k1, "radial distortion, 2nd order");
  table.add("k2", &S::k2, "radial distortion, 4th order");
  table.add("p1", &S::p1, "tangential distortion");
  table.add("p2", &S::p2, "tangential distortion");
  table.add("k3", &S::k3, "radial distortion, 6th order");
  table.add("k4", &S::k4,
            "radial distortion: of the denominator, 2nd order; of a fisheye lens, 9th power of the angle");
  table.add("k5", &S::k5, "radial distortion: of the denominator, 4th order");
  table.add("k6", &S::k6, "radial distortion: of the denominator, 6th order");
  table
      .add("lens", &S::lens,
           "meaning of the coefficients, as in OpenCV: radial_tangential with k1, k2, p1, p2, k3 and, of the rational "
           "model, k4, k5, k6; fisheye (Kannala-Brandt) with k1, k2, k3, k4")
      .one_of(lens_names());
  table.add("baseline", &S::baseline, "of the stereo pair that depth stands for").range(1e-4, 100).unit("m");
  table.add("frame_rate", &S::frame_rate, "images per second").range(0.01, 10000).unit("1/s");
  table
      .add("readout", &S::readout,
           "time from the exposure of the first row to that of the last, of a camera with a rolling shutter; below 0: "
           "the last row comes first")
      .range(-0.1, 0.1)
      .unit("s");
}

CameraSettings camera_settings(const Camera& camera) {
  const Distortion& d = camera.distortion;
  return {camera.name,
          camera.width,
          camera.height,
          camera.fx,
          camera.fy,
          camera.cx,
          camera.cy,
          d.k1,
          d.k2,
          d.p1,
          d.p2,
          d.k3,
          d.k4,
          d.k5,
          d.k6,
          lens_name(d.lens),
          camera.baseline,
          camera.frame_rate,
          camera.readout};
}

Camera make_camera(const CameraSettings& s) {
  const Distortion distortion{
      s.k1, s.k2, s.p1, s.p2, s.k3, s.k4, s.k5, s.k6, find_lens(s.lens).value_or(Lens::radial_tangential)};
  return {s.name, s.width, s.height, s.fx, s.fy, s.cx, s.cy, distortion, s.baseline, s.frame_rate, s.readout};
}

std::optional<Camera> read_camera(const ConfigurationNode& node, std::vector<Diagnostic>& diagnostics,
                                  const FindParameter& elsewhere) {
  if (node.kind == ConfigurationNode::Kind::scalar) {
    const std::optional<Camera> camera = find_camera(node.text);
    if (!camera)
      diagnostics.push_back({node.location, "there is no known camera '" + node.text +
                                                "'; expected a name, or numbers as { width: 640, height: 480, fx: ... "
                                                "}; " +
                                                did_you_mean(node.text, camera_names())});
    return camera;
  }
  const ParameterTable<CameraSettings> table;
  std::vector<Parameter> parameters = table.parameters();
  // A known name gives the numbers that are not given.
  const ConfigurationNode* name = node.find("name");
  if (name != nullptr && name->kind == ConfigurationNode::Kind::scalar && !name->text.empty()) {
    const std::optional<Camera> known = find_camera(name->text);
    if (!known) {
      diagnostics.push_back({name->location, "there is no known camera '" + name->text + "'; " +
                                                 did_you_mean(name->text, camera_names())});
      return std::nullopt;
    }
    const ParameterValues numbers = table.values(camera_settings(*known));
    for (Parameter& parameter : parameters) {
      parameter.is_required = false;
      parameter.default_value = numbers.at(parameter.name);
    }
  }
  const std::size_t before = diagnostics.size();
  const ParameterValues values = read_parameters(node, parameters, "section 'camera'", diagnostics, elsewhere);
  if (diagnostics.size() != before) return std::nullopt;
  Camera camera = make_camera(table.settings(values));
  if (const std::string trouble = camera.trouble(); !trouble.empty()) {
    const ConfigurationNode* lens = node.find("lens");
    diagnostics.push_back({lens != nullptr ? lens->location : node.location, trouble});
    return std::nullopt;
  }
  return camera;
}

const std::vector<std::string>& choice_sections() {
  static const std::vector<std::string> names = {"source",    "features",  "matcher",
                                                 "segmenter", "optimizer", "loop_detector"};
  return names;
}

namespace {

using Kind = ConfigurationNode::Kind;

/// The known camera that the folder of a recording is named after: rgbd_dataset_freiburg1_* is tum_fr1 (2 and 3
/// likewise), rgbd_bonn_* is bonn, and a name that begins with that of a known camera and '_' is of that camera.
std::optional<std::string> camera_of_recording(const std::string& folder) {
  static const std::pair<const char*, const char*> published[] = {{"rgbd_bonn_", "bonn"},
                                                                  {"rgbd_dataset_freiburg1_", "tum_fr1"},
                                                                  {"rgbd_dataset_freiburg2_", "tum_fr2"},
                                                                  {"rgbd_dataset_freiburg3_", "tum_fr3"}};
  for (const auto& [beginning, camera] : published)
    if (folder.starts_with(beginning)) return camera;
  for (const std::string& camera : camera_names())
    if (folder.starts_with(camera + "_")) return camera;
  return std::nullopt;
}

class Resolver {
 public:
  Resolver(ConfigurationNode root, std::string file, Registry& registry,
           const std::vector<SectionDescription>& sections)
      : root_(std::move(root)), file_(std::move(file)), registry_(registry), sections_(sections) {
    elsewhere_ = [this](const std::string& name) { return ParameterPlaces(root_, registry_, sections_).find(name); };
  }

  Configuration resolve() {
    result_.file = file_;
    if (root_.kind != Kind::map) {
      complain({file_},
               "found " + root_.found() + "; expected a map with the sections source, features, optimizer, ...");
      throw ConfigurationError(diagnostics_);
    }
    replace_renamed_keys(root_, result_.warnings, diagnostics_);
    load_plugins();
    check_section_names();
    result_.source = choose("source", nullptr);
    result_.features = choose("features", nullptr);
    result_.optimizer = choose("optimizer", nullptr);
    result_.matcher = choose_matcher();
    result_.segmenter = choose("segmenter", "none");
    result_.loop_detector = choose("loop_detector", "none");
    result_.filters = chain("filters");
    result_.observers = chain("observers");
    read_camera();
    read_imu();
    read_sensor();
    read_run();
    for (const SectionDescription& section : sections_) read_section(section);
    warn_of_unused_masks();
    // As a reader goes through the file; what has no line comes last.
    std::stable_sort(diagnostics_.begin(), diagnostics_.end(), [](const Diagnostic& a, const Diagnostic& b) {
      const auto key = [](const SourceLocation& l) { return std::tuple(l.line == 0, l.line, l.column); };
      return key(a.location) < key(b.location);
    });
    if (!diagnostics_.empty()) throw ConfigurationError(diagnostics_);
    return std::move(result_);
  }

 private:
  void complain(const SourceLocation& location, const std::string& message) {
    diagnostics_.push_back({location, message});
  }

  const ConfigurationNode& at(const std::string& section) const {
    static const ConfigurationNode nothing;
    const ConfigurationNode* node = root_.find(section);
    return node != nullptr ? *node : nothing;
  }

  void load_plugins() {
    const ConfigurationNode& node = at("plugins");
    if (node.kind == Kind::nothing) return;
    if (node.kind != Kind::list) {
      complain(node.location, "found " + node.found() + " for 'plugins'; expected a list of files");
      return;
    }
    for (const ConfigurationNode& item : node.items) {
      if (item.kind != Kind::scalar) {
        complain(item.location, "found " + item.found() + "; expected the file of a plugin");
        continue;
      }
      std::string name = item.text;
      const bool has_folder = name.find('/') != std::string::npos;
      if (has_folder && std::filesystem::path(name).is_relative())
        name = (item.folder / name).lexically_normal().string();
      try {
        result_.plugins.push_back(load_plugin(registry_, name, {item.folder}).string());
      } catch (const PluginError& error) {
        complain(item.location, error.what());
      }
    }
  }

  void check_section_names() {
    std::vector<std::string> known = choice_sections();
    known.insert(known.end(), {"filters", "observers", "camera", "imu", "sensor", "run", "plugins"});
    for (const SectionDescription& section : sections_) known.push_back(section.name);
    for (const ConfigurationNode::Entry& entry : root_.entries)
      if (std::find(known.begin(), known.end(), entry.key) == known.end())
        complain(entry.location,
                 "there is no section '" + entry.key + "'; " + suggest_parameter(entry.key, known, elsewhere_));
  }

  ModuleChoice module(const std::string& kind, const std::string& name, const SourceLocation& location,
                      const ConfigurationNode& parameters) {
    ModuleChoice choice{kind, name, {}, location};
    const ModuleEntry* entry = find_module(registry_, kind, name, location, diagnostics_);
    if (entry == nullptr) return choice;
    ConfigurationNode given = parameters;
    if (given.location.file.empty()) given.location = location;
    choice.values = read_parameters(given, entry->parameters, kind + " '" + name + "'", diagnostics_, elsewhere_);
    return choice;
  }

  ModuleChoice module(const std::string& kind, const ConfigurationNode& node) {
    if (node.kind == Kind::scalar)
      return module(kind, node.text, node.location, ConfigurationNode{.location = node.location, .entries = {}});
    const bool one = node.kind == Kind::map && node.entries.size() == 1;
    if (!one) {
      std::string found = node.found();
      if (node.kind == Kind::map) {
        found = std::to_string(node.entries.size()) + " keys";
        for (std::size_t i = 0; i < node.entries.size(); ++i) found += (i == 0 ? " (" : ", ") + node.entries[i].key;
        if (!node.entries.empty()) found += ")";
      }
      complain(node.location, "found " + found + " for '" + kind +
                                  "'; expected one module, as `name` or { name: { ... } }; " +
                                  did_you_mean("", registry_.names(kind)));
      return {kind, {}, {}, node.location};
    }
    const ConfigurationNode::Entry& entry = node.entries.front();
    ConfigurationNode parameters = entry.value;
    if (parameters.kind == Kind::nothing) parameters.location = entry.location;
    return module(kind, entry.key, entry.location, parameters);
  }

  ModuleChoice choose(const std::string& kind, const char* fallback) {
    const ConfigurationNode& node = at(kind);
    if (node.kind != Kind::nothing) return module(kind, node);
    if (fallback != nullptr)
      return module(kind, fallback, {file_}, ConfigurationNode{.location = {file_}, .entries = {}});
    const bool is_empty = !node.location.file.empty();
    complain(is_empty ? node.location : SourceLocation{file_},
             "section '" + kind + "' is " + (is_empty ? "empty" : "missing") + "; expected one module; " +
                 did_you_mean("", registry_.names(kind)));
    return {kind, {}, {}, {file_}};
  }

  /// The default matcher is part of the pipeline, also where a program registers no module of this kind.
  ModuleChoice choose_matcher() {
    const char* fallback = "nearest";
    const ConfigurationNode& node = at("matcher");
    const bool is_named = node.kind == Kind::map && node.entries.size() == 1 && node.entries[0].key == fallback;
    if ((node.kind == Kind::nothing || is_named) && registry_.find("matcher", fallback) == nullptr)
      return {"matcher", fallback, {}, {file_}};
    return choose("matcher", fallback);
  }

  std::vector<ModuleChoice> chain(const std::string& kind) {
    const ConfigurationNode& node = at(kind);
    std::vector<ModuleChoice> choices;
    if (node.kind == Kind::nothing) return choices;
    if (node.kind != Kind::list) {
      complain(node.location,
               "found " + node.found() + " for '" + kind + "'; expected a list, such as [ a, b: { ... } ]");
      return choices;
    }
    for (const ConfigurationNode& item : node.items) choices.push_back(module(kind, item));
    return choices;
  }

  void read_camera() {
    const ConfigurationNode& node = at("camera");
    if (node.kind == Kind::nothing) return;
    const std::string folder = source_folder();
    const std::optional<std::string> named = camera_of_recording(folder);
    if (node.kind == Kind::scalar && node.text == "auto") {
      if (named) result_.camera = find_camera(*named);
      const std::string known_by_name = folder.empty()
                                            ? ""
                                            : ", and the name of the folder '" + folder +
                                                  "' says none, as rgbd_dataset_freiburg1_xyz or rgbd_bonn_crowd would";
      result_.unknown_camera =
          Diagnostic{node.location, "found 'auto' for 'camera', but the source '" + result_.source.name +
                                        "' does not know its own" + known_by_name + "; expected a name or numbers"};
      return;
    }
    result_.camera = holdfast::read_camera(node, diagnostics_, elsewhere_);
    if (result_.camera && node.kind == Kind::map)
      for (const std::string& suspicion : result_.camera->suspicions(true))
        add_warning(result_.warnings, {node.location, suspicion});
    if (named && result_.camera && result_.camera->name != *named && find_camera(result_.camera->name))
      result_.warnings.push_back({node.location, "found the camera '" + result_.camera->name + "' for the folder '" +
                                                     folder + "'; expected '" + *named +
                                                     "' by the name of the folder; write 'camera: auto' to follow it"});
  }

  void read_imu() {
    const ConfigurationNode& node = at("imu");
    if (node.kind == Kind::nothing) return;
    result_.imu = holdfast::read_imu(node, diagnostics_, elsewhere_);
    result_.imu_location = node.location;
  }

  void read_sensor() {
    const ConfigurationNode& node = at("sensor");
    if (node.kind == Kind::nothing || (node.kind == Kind::scalar && node.text == "auto")) return;
    if (node.kind == Kind::scalar) result_.sensor = find_sensor(node.text);
    if (result_.sensor) return;
    std::vector<std::string> known = sensor_names();
    known.insert(known.begin(), "auto");
    complain(node.location, "found " + node.found() + " for 'sensor'; " +
                                did_you_mean(node.kind == Kind::scalar ? node.text : "", known));
  }

  /// The name of the folder that the source reads; "" for a source without one.
  std::string source_folder() const {
    const ModuleEntry* entry = registry_.find("source", result_.source.name);
    const auto value = result_.source.values.find("path");
    if (entry == nullptr || value == result_.source.values.end()) return "";
    const bool is_path = std::any_of(entry->parameters.begin(), entry->parameters.end(), [](const Parameter& each) {
      return each.name == "path" && each.type == ParameterType::path;
    });
    if (!is_path || std::get<std::string>(value->second).empty()) return "";
    return folder_name(std::get<std::string>(value->second));
  }

  void read_run() {
    const ParameterTable<RunSettings> table;
    const ConfigurationNode& node = at("run");
    result_.run = table.settings(read_parameters(node, table.parameters(), "section 'run'", diagnostics_, elsewhere_));
    if (const auto reason = result_.run.contradiction()) complain(node.find("pace")->location, *reason);
    warn_of_run_settings(node);
  }

  /// Settings that the mode or the pace leaves unused. Defaults are those of a resolved configuration and ask for
  /// nothing.
  void warn_of_run_settings(const ConfigurationNode& node) {
    const RunSettings &run = result_.run, defaults;
    const auto warn = [&](const char* name, const std::string& reason) {
      const ConfigurationNode* found = node.find(name);
      result_.warnings.push_back({found != nullptr ? found->location : node.location,
                                  "'" + std::string(name) + "' of section 'run' has no effect " + reason});
    };
    if (run.late_frames == LateFrames::drop && !run.paced())
      warn("late_frames",
           "as 'drop', because frames are late only at the pace of their time stamps; add 'mode: threaded' and 'pace: "
           "timestamps', or remove it");
    const std::string in_mode =
        "in " + std::string(run.threaded() ? "threaded" : "sequential") + " mode; change 'mode', or remove it";
    if (!run.threaded() && run.frame_queue != defaults.frame_queue) warn("frame_queue", in_mode);
    if (!run.threaded() && run.keyframe_queue != defaults.keyframe_queue) warn("keyframe_queue", in_mode);
    if (run.threaded() && run.prefetch != defaults.prefetch) warn("prefetch", in_mode);
  }

  /// Masks reach poses by filters alone. A dense map and a surface leave out what they mark without any.
  void warn_of_unused_masks() {
    if (!diagnostics_.empty()) return;  // values that were not read are missing
    const auto is_enabled = [&](const char* name) {
      const auto section = result_.sections.find(name);
      return section != result_.sections.end() && std::get<bool>(section->second.at("enabled"));
    };
    if (result_.segmenter.name == "none" || !result_.filters.empty() || is_enabled("dense_map") ||
        is_enabled("surface"))
      return;
    result_.warnings.push_back(
        {result_.segmenter.location,
         "no filter uses the masks of the segmenter '" + result_.segmenter.name +
             "', so that poses are estimated from features on people as from all others; add 'semantic_mask' to "
             "'filters', or remove the segmenter to save its time"});
  }

  void read_section(const SectionDescription& section) {
    result_.sections[section.name] = read_parameters(at(section.name), section.parameters,
                                                     "section '" + section.name + "'", diagnostics_, elsewhere_);
  }

  ConfigurationNode root_;
  std::string file_;
  Registry& registry_;
  const std::vector<SectionDescription>& sections_;
  FindParameter elsewhere_;
  std::vector<Diagnostic> diagnostics_;
  Configuration result_;
};

}  // namespace

Configuration resolve_configuration(const ConfigurationNode& root, const std::string& file, Registry& registry,
                                    const std::vector<SectionDescription>& sections) {
  return Resolver(root, file, registry, sections).resolve();
}

Configuration read_configuration(const std::filesystem::path& file, const std::vector<std::string>& overrides,
                                 Registry& registry, const std::vector<SectionDescription>& sections) {
  ConfigurationNode root = read_yaml(file);
  std::vector<Diagnostic> wrong_overrides;
  for (const std::string& override_text : overrides) {
    try {
      apply_override(root, override_text, choice_sections());
    } catch (const ConfigurationError& error) {
      wrong_overrides.insert(wrong_overrides.end(), error.diagnostics().begin(), error.diagnostics().end());
    }
  }
  // Alone: what they would have set may be what is missing.
  if (!wrong_overrides.empty()) throw ConfigurationError(std::move(wrong_overrides));
  return resolve_configuration(root, file.string(), registry, sections);
}

}  // namespace holdfast
