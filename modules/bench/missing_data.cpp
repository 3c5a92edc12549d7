// SPDX-License-Identifier: BSD-3-Clause
#include "missing_data.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "holdfast/config/parameter_reader.hpp"
#include "holdfast/image_files/image_sequence.hpp"
#include "holdfast/image_files/recording_pairs.hpp"

namespace holdfast {

namespace fs = std::filesystem;

namespace {

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

Diagnostic missing(const MatrixSequence& sequence, const std::string& what) {
  return {sequence.location,
          "sequence '" + sequence.name + "': " + what + (sequence.about.empty() ? "" : "; " + sequence.about)};
}

std::string unset(const PlacedText& variable) {
  return "the variable '" + variable.text + "' is not set; set it in the environment or by --data " + variable.text +
         "=FOLDER";
}

std::optional<PlacedText> unset_variable(const MatrixSequence& sequence) {
  if (auto name = missing_variable(sequence.source)) return name;
  for (const KeyValue& change : sequence.overrides)
    if (auto name = missing_variable(change.value)) return name;
  return std::nullopt;
}

std::string text_of(const ParameterValues& values, const std::string& name) {
  const auto value = values.find(name);
  return value == values.end() ? "" : std::get<std::string>(value->second);
}

/// A recording in TUM layout that lacks one of its lists.
std::optional<std::string> missing_list(const fs::path& folder, const std::string& associations,
                                        bool needs_depth = true) {
  if (!is_there(folder)) return "the folder '" + folder.string() + "' is missing";
  for (const char* list : {"rgb.txt", "depth.txt", "groundtruth.txt"}) {
    if (!associations.empty() && std::string(list) != "groundtruth.txt") continue;
    if (!needs_depth && std::string(list) == "depth.txt") continue;
    if (!is_there(folder / list))
      return "'" + (folder / list).string() + "' is missing" +
             (std::string(list) == "groundtruth.txt" ? ", and without truth there is nothing to measure" : "");
  }
  return std::nullopt;
}

}  // namespace

std::optional<Diagnostic> missing_data(const MatrixSequence& sequence, const Configuration& configuration,
                                       const Registry& registry) {
  if (const auto variable = unset_variable(sequence)) return missing(sequence, unset(*variable));
  const ParameterValues& source = configuration.source.values;
  if (const fs::path list = fs::path(text_of(source, "path")) / "associations.txt";
      configuration.source.name == "icl_nuim" && is_there(list.parent_path()) && !is_there(list))
    return missing(sequence, "'" + list.string() + "' is missing");
  if (configuration.source.name == "tum")
    if (const auto list = missing_list(text_of(source, "path"), text_of(source, "associations"),
                                       configuration.sensor != Sensor::mono))
      return missing(sequence, *list);
  for (const ModuleChoice* choice : {&configuration.source, &configuration.segmenter, &configuration.features,
                                     &configuration.matcher, &configuration.loop_detector}) {
    const ModuleEntry* entry = registry.find(choice->kind, choice->name);
    if (entry == nullptr) continue;
    for (const Parameter& parameter : entry->parameters) {
      if (parameter.type != ParameterType::path) continue;
      const std::string path = text_of(choice->values, parameter.name);
      if (path.empty() || is_there(path)) continue;
      return missing(sequence, "'" + path + "' is missing, which " + choice->kind + "." + choice->name + "." +
                                   parameter.name + " names; correct it, or give it under `overrides` of the sequence");
    }
  }
  return std::nullopt;
}

bool is_program_in_path(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((fs::path(folder) / name).c_str(), X_OK) == 0) return true;
  return false;
}

std::optional<Diagnostic> missing_program(const ExternalSystem& system) {
  std::vector<std::string> texts = system.command;
  texts.insert(texts.end(), {system.folder, system.trajectory});
  for (const auto& [name, value] : system.environment) texts.push_back(value);
  for (const std::string& text : texts)
    if (const auto name = missing_variable(text))
      return Diagnostic{system.location, "system '" + system.name + "': " + unset({*name, system.location})};
  const std::string& program = system.command.front();
  if (program.find('/') != std::string::npos && program.find('{') == std::string::npos && !is_there(program))
    return Diagnostic{system.location, "system '" + system.name + "': the program '" + program + "' is missing"};
  if (program.find_first_of("/{") == std::string::npos && !is_program_in_path(program))
    return Diagnostic{system.location, "system '" + system.name + "': the program '" + program + "' is not in PATH"};
  return std::nullopt;
}

void require_plain_lens(const Camera& camera, const MatrixSequence& sequence, std::vector<Diagnostic>& diagnostics) {
  const Distortion& distortion = camera.distortion;
  if (distortion.lens == Lens::radial_tangential && !distortion.is_rational()) return;
  diagnostics.push_back({sequence.camera ? sequence.camera->location : sequence.location,
                         "the camera of sequence '" + sequence.name +
                             "' has a lens that external systems get no settings for; expected k1, k2, p1, p2 and k3 "
                             "alone"});
}

std::optional<RecordedSequence> recorded_sequence(const MatrixSequence& sequence, const Registry& registry,
                                                  const std::optional<Camera>& camera_by_folder,
                                                  std::vector<Diagnostic>& diagnostics,
                                                  std::vector<Diagnostic>& missing_ones) {
  const ConfigurationNode* tum = sequence.source.find("tum");
  const ModuleEntry* entry = registry.find("source", "tum");
  if (tum == nullptr || entry == nullptr) {
    diagnostics.push_back({sequence.location, "sequence '" + sequence.name + "' is no recording in TUM layout"});
    return std::nullopt;
  }
  RecordedSequence recorded;
  recorded.name = sequence.name;
  const std::size_t before = diagnostics.size();
  if (!sequence.camera)
    diagnostics.push_back({sequence.location, "sequence '" + sequence.name +
                                                  "' needs 'camera', because external systems get a settings file for "
                                                  "it; expected a known name, numbers, or auto"});
  else if (sequence.camera->kind == ConfigurationNode::Kind::scalar && sequence.camera->text == "auto") {
    if (!camera_by_folder) return std::nullopt;  // the plan has said that it is unknown
    recorded.camera = *camera_by_folder;
  } else if (const auto camera = read_camera(*sequence.camera, diagnostics))
    recorded.camera = *camera;
  require_plain_lens(recorded.camera, sequence, diagnostics);
  const ParameterValues values = read_parameters(*tum, entry->parameters, "source 'tum'", diagnostics);
  if (diagnostics.size() != before) return std::nullopt;
  if (const auto variable = unset_variable(sequence)) {
    missing_ones.push_back(missing(sequence, unset(*variable)));
    return std::nullopt;
  }
  recorded.folder = fs::absolute(text_of(values, "path"));
  recorded.depth_factor = std::get<double>(values.at("depth_factor"));
  const std::string associations = text_of(values, "associations");
  if (const auto list = missing_list(recorded.folder, associations)) {
    missing_ones.push_back(missing(sequence, *list));
    return std::nullopt;
  }
  try {
    recorded.truth = choose_truth_transform({.is_raw = text_of(values, "truth_frame") == "raw",
                                             .left = std::get<RealTable>(values.at("truth_left")),
                                             .right = std::get<RealTable>(values.at("truth_right")),
                                             .place = "source.tum"},
                                            recorded.folder / "groundtruth.txt", recorded.camera);
    recorded.frames =
        recording_pairs(recorded.folder, associations, std::get<double>(values.at("max_time_difference")));
    select_range(recorded.frames, std::get<std::int64_t>(values.at("start")),
                 std::get<std::int64_t>(values.at("frames")), recorded.folder, "colour and depth pairs");
  } catch (const InputError& error) {
    missing_ones.push_back(missing(sequence, error.what()));
    return std::nullopt;
  }
  return recorded;
}

}  // namespace holdfast
