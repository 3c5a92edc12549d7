// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "bindings.hpp"
#include "fed_frames.hpp"
#include "gil.hpp"
#include "holdfast/config/configuration_node.hpp"
#include "holdfast/config/reference.hpp"
#include "holdfast/perturbation/perturbation_settings.hpp"
#include "holdfast/run/configured_pipeline.hpp"
#include "holdfast/simulation/scene_file.hpp"
#include "registry.hpp"

namespace holdfast::python {

namespace py = pybind11;

namespace {

void apply_overrides(ConfigurationNode& root, const std::vector<std::string>& overrides) {
  std::vector<Diagnostic> wrong;
  for (const std::string& text : overrides) {
    try {
      apply_override(root, text, choice_sections());
    } catch (const ConfigurationError& error) {
      wrong.insert(wrong.end(), error.diagnostics().begin(), error.diagnostics().end());
    }
  }
  if (!wrong.empty()) throw ConfigurationError(std::move(wrong));
}

/// Frames of the caller are not perturbed, but the pipeline's camera would be.
void refuse_perturbation(const Configuration& configuration, const ConfigurationNode& root) {
  if (section_settings<PerturbationSettings>(configuration, "perturbation").is_nothing()) return;
  throw ConfigurationError(root.find("perturbation")->location,
                           "'perturbation' changes the frames of the configuration's source, and this pipeline gets "
                           "its frames from the caller; remove the section, or use holdfast.run");
}

/// `text` is YAML and `name` its place in messages; without `text`, `name` is a file. With `fed`, frames come from the
/// caller whatever the source is. `modules` are those of make_registry().
Configuration load(const std::string& name, const std::optional<std::string>& text, const std::filesystem::path& folder,
                   const std::vector<std::string>& overrides, bool fed, const py::list& modules) {
  Registry registry = make_registry(modules);
  const Unlock unlock;
  ConfigurationNode root = text ? parse_yaml(*text, name, folder) : read_yaml(name);
  apply_overrides(root, overrides);
  if (fed) feed_from_caller(root);
  Configuration configuration = resolve_configuration(root, name, registry, pipeline_sections());
  if (fed) refuse_perturbation(configuration, root);
  return configuration;
}

py::dict dictionary_of(const ModuleChoice& choice) {
  py::dict module;
  module[py::str(choice.name)] = py::cast(choice.values);
  return module;
}

py::list dictionaries_of(const std::vector<ModuleChoice>& chain) {
  py::list modules;
  for (const ModuleChoice& choice : chain) modules.append(dictionary_of(choice));
  return modules;
}

/// The resolved configuration as a mapping, in the sections of a file.
py::dict to_dictionary(const Configuration& configuration) {
  py::dict all;
  all["source"] = dictionary_of(configuration.source);
  if (configuration.camera)
    all["camera"] = py::cast(ParameterTable<CameraSettings>().values(camera_settings(*configuration.camera)));
  if (configuration.imu) all["imu"] = py::cast(ParameterTable<ImuSettings>().values(imu_settings(*configuration.imu)));
  all["features"] = dictionary_of(configuration.features);
  all["segmenter"] = dictionary_of(configuration.segmenter);
  all["filters"] = dictionaries_of(configuration.filters);
  all["optimizer"] = dictionary_of(configuration.optimizer);
  all["matcher"] = dictionary_of(configuration.matcher);
  all["loop_detector"] = dictionary_of(configuration.loop_detector);
  all["observers"] = dictionaries_of(configuration.observers);
  for (const auto& [section, values] : configuration.sections) all[py::str(section)] = py::cast(values);
  all["run"] = py::cast(ParameterTable<RunSettings>().values(configuration.run));
  all["plugins"] = py::cast(configuration.plugins);
  return all;
}

std::vector<std::string> warnings_of(const Configuration& configuration) {
  std::vector<std::string> texts;
  for (const Diagnostic& warning : configuration.warnings) texts.push_back(warning.to_string());
  return texts;
}

/// The sections that `holdfast modules` lists.
std::vector<SectionDescription> all_sections() {
  std::vector<SectionDescription> sections = pipeline_sections();
  const std::vector<SectionDescription> scenes = simulation::scene_sections();
  sections.insert(sections.end(), scenes.begin(), scenes.end());
  return sections;
}

}  // namespace

void bind_configurations(py::module_& module) {
  py::class_<Configuration>(module, "Configuration",
                            "A configuration in which every name is known and every value is in range.")
      .def_readonly("file", &Configuration::file)
      .def_property_readonly("warnings", &warnings_of)
      .def("to_yaml", [](const Configuration& configuration) { return to_yaml(configuration); })
      .def("to_dict", &to_dictionary);
  module.def("load_configuration", &load, py::arg("name"), py::arg("text"), py::arg("folder"), py::arg("overrides"),
             py::arg("fed"), py::arg("modules"));
  module.def("reference_json", [] { return reference(make_registry(), all_sections(), "", ReferenceFormat::json); });
}

}  // namespace holdfast::python
