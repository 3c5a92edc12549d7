// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <map>
#include <string>
#include <utility>

#include "bindings.hpp"
#include "fed_frames.hpp"
#include "holdfast/plugin/builtin.hpp"
#include "instance.hpp"
#include "registry.hpp"

namespace holdfast::python {

namespace py = pybind11;

namespace {

using Key = std::pair<std::string, std::string>;  // kind and name
using Maker = std::unique_ptr<Module> (*)(Instance);

/// What Python code has registered in this process; the lock guards it. It is never destroyed, because it holds objects
/// of Python.
std::map<Key, ModuleEntry>& registered() {
  static auto* const modules = new std::map<Key, ModuleEntry>;
  return *modules;
}

const std::map<std::string, Maker>& makers() {
  static const std::map<std::string, Maker> all = {{"source", make_source},
                                                   {"features", make_extractor},
                                                   {"segmenter", make_segmenter},
                                                   {"filters", make_filter},
                                                   {"observers", make_observer}};
  return all;
}

ParameterType type_of(const std::string& name) {
  for (const ParameterType type :
       {ParameterType::boolean, ParameterType::integer, ParameterType::real, ParameterType::text, ParameterType::path,
        ParameterType::text_list, ParameterType::real_list})
    if (name == to_string(type)) return type;
  throw PluginError("there is no parameter type '" + name + "'");
}

ParameterValue value_of(const py::handle& value, ParameterType type) {
  switch (type) {
    case ParameterType::boolean:
      return value.cast<bool>();
    case ParameterType::integer:
      return value.cast<std::int64_t>();
    case ParameterType::real:
      return value.cast<double>();
    case ParameterType::text_list:
      return value.cast<std::vector<std::string>>();
    case ParameterType::real_list:
      return value.cast<std::vector<double>>();
    default:
      return std::string(py::str(value));
  }
}

Parameter parameter_of(const py::dict& row) {
  Parameter parameter;
  parameter.name = row["name"].cast<std::string>();
  parameter.type = type_of(row["type"].cast<std::string>());
  parameter.help = row["help"].cast<std::string>();
  parameter.unit_name = row["unit"].cast<std::string>();
  parameter.is_required = row["required"].cast<bool>();
  parameter.default_value = value_of(row["default"], parameter.type);
  if (!row["minimum"].is_none()) parameter.minimum = row["minimum"].cast<double>();
  if (!row["maximum"].is_none()) parameter.maximum = row["maximum"].cast<double>();
  parameter.allowed = row["one_of"].cast<std::vector<std::string>>();
  return parameter;
}

py::dict dictionary_of(const CreationContext& context) {
  py::dict dictionary;
  dictionary["camera"] = context.camera;
  dictionary["seed"] = context.seed;
  dictionary["sequential"] = context.sequential;
  dictionary["output_directory"] = context.output_directory.string();
  dictionary["class_names"] = context.class_names;
  return dictionary;
}

/// What making a module raises in Python becomes an InputError.
template <class Making>
std::unique_ptr<Module> guarded(const std::filesystem::path& file, Making making) {
  try {
    return making();
  } catch (const py::error_already_set& raised) {
    throw_caused_error(raised, file, "making the module");
  }
}

/// Registers `factory`(values, context) as the module of this kind and name.
void register_module(const std::string& kind, const std::string& name, const std::string& summary,
                     const std::string& paper, const std::string& licence, const std::string& origin,
                     const std::filesystem::path& file, const std::vector<py::dict>& parameters,
                     const py::object& factory, bool replace) {
  const auto maker = makers().find(kind);
  if (maker == makers().end()) throw PluginError("Python modules of the kind '" + kind + "' are not supported");
  Registry builtin;
  register_builtin_plugins(builtin);
  const auto found = registered().find({kind, name});
  if (builtin.find(kind, name) != nullptr || (found != registered().end() && !replace))
    throw PluginError(
        kind + " module '" + name + "' of " + origin + " cannot be registered: the name is taken by one of " +
        (found != registered().end() ? found->second.origin : "Holdfast itself") + "; rename one of them");
  ModuleEntry entry{kind, {.name = name, .summary = summary, .paper = paper, .licence = licence}, origin, {}, {}};
  for (const py::dict& row : parameters) entry.parameters.push_back(parameter_of(row));
  entry.create = [make = maker->second, shared = SharedObject(factory), file](const ParameterValues& values,
                                                                              const CreationContext& context) {
    const Lock lock;
    return guarded(file, [&] { return make(Instance(shared.get()(values, dictionary_of(context)), file)); });
  };
  registered().insert_or_assign({kind, name}, std::move(entry));
}

/// Adds a module that exists already, under a name by which a configuration selects it.
void add_given(Registry& registry, const py::tuple& given) {
  const auto kind = given[0].cast<std::string>();
  const std::filesystem::path file = given[2].cast<std::string>();
  ModuleEntry entry{
      kind,
      {.name = given[1].cast<std::string>(), .summary = "Given as an object.", .paper = "", .licence = ""},
      file.string(),
      {},
      {}};
  entry.create = [make = makers().at(kind), shared = SharedObject(given[3]), file](const ParameterValues&,
                                                                                   const CreationContext&) {
    const Lock lock;
    return guarded(file, [&] { return make(Instance(shared.get(), file)); });
  };
  registry.add(std::move(entry));
}

py::list registered_names() {
  py::list names;
  for (const auto& [key, entry] : registered()) names.append(py::make_tuple(key.first, key.second));
  return names;
}

/// The registered modules for another extension.
py::capsule registered_registry() {
  auto registry = std::make_unique<Registry>();
  add_registered(*registry);
  return {registry.release(), [](void* held) { delete static_cast<Registry*>(held); }};
}

}  // namespace

Registry make_registry(const py::list& given) {
  Registry registry;
  register_builtin_plugins(registry);
  register_fed_frames(registry);
  add_registered(registry);
  for (const py::handle& module : given) add_given(registry, py::reinterpret_borrow<py::tuple>(module));
  return registry;
}

void add_registered(Registry& registry) {
  for (const auto& [key, entry] : registered()) registry.add(entry);
}

void bind_modules(py::module_& module) {
  module.def("register_module", &register_module, py::arg("kind"), py::arg("name"), py::arg("summary"),
             py::arg("paper"), py::arg("licence"), py::arg("origin"), py::arg("file"), py::arg("parameters"),
             py::arg("factory"), py::arg("replace"));
  module.def("unregister_module", [](const std::string& kind, const std::string& name) {
    return registered().erase({kind, name}) > 0;
  });
  module.def("registered_modules", &registered_names);
  module.def("registered_registry", &registered_registry);
}

}  // namespace holdfast::python
