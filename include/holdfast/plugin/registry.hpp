// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/core/module.hpp"
#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

/// What the reference says about a module.
struct ModuleDescription {
  std::string name = {};     ///< key in the configuration: lower case, words joined by _
  std::string summary = {};  ///< one sentence
  std::string paper = {};    ///< what it implements, "" when nothing published
  std::string licence = "BSD-3-Clause";
};

/// A registered module: its description, its parameter table and how to make one.
struct ModuleEntry {
  std::string kind;  ///< the section of the configuration: source, features, ...
  ModuleDescription description;
  std::string origin;  ///< "built in" or the file of the plugin
  std::vector<Parameter> parameters;
  std::function<std::unique_ptr<Module>(const ParameterValues&, const CreationContext&)> create;
};

/// All modules that configurations can name, by kind and name. A value, not a global: two registries in one process do
/// not know of each other. Not synchronised.
class Registry {
 public:
  /// Registers a module. Interface is one of interfaces/*.hpp (it names its kind), Settings a struct with describe().
  /// Throws PluginError when the kind already has a module of that name.
  template <class Interface, class Settings>
  void add(ModuleDescription description,
           std::function<std::unique_ptr<Interface>(const Settings&, const CreationContext&)> create) {
    auto table = std::make_shared<const ParameterTable<Settings>>();
    ModuleEntry entry{Interface::kind, std::move(description), origin_, table->parameters(), {}};
    entry.create = [table, create = std::move(create)](const ParameterValues& values, const CreationContext& context) {
      return std::unique_ptr<Module>(create(table->settings(values), context));
    };
    add_entry(std::move(entry));
  }

  /// Shorthand for a module with a constructor Implementation(const Settings&, const CreationContext&).
  template <class Interface, class Implementation, class Settings>
  void add(ModuleDescription description) {
    add<Interface, Settings>(std::move(description), [](const Settings& settings, const CreationContext& context) {
      return std::unique_ptr<Interface>(std::make_unique<Implementation>(settings, context));
    });
  }

  const ModuleEntry* find(const std::string& kind, const std::string& name) const;
  /// Entries of a kind, by name.
  std::vector<const ModuleEntry*> of_kind(const std::string& kind) const;
  /// Kinds that have a module, sorted.
  std::vector<std::string> kinds() const;
  /// Names of a kind's modules, sorted.
  std::vector<std::string> names(const std::string& kind) const;

  /// Makes a module; the values must have passed the checks of its table. Throws PluginError for an unknown name and
  /// passes on what the module throws.
  template <class Interface>
  std::unique_ptr<Interface> create(const std::string& name, const ParameterValues& values,
                                    const CreationContext& context) const {
    const ModuleEntry& entry = require(Interface::kind, name);
    return std::unique_ptr<Interface>(static_cast<Interface*>(entry.create(values, context).release()));
  }

  /// Names where the modules added next come from; the plugin loader sets it.
  void set_origin(std::string origin) { origin_ = std::move(origin); }
  const std::string& origin() const { return origin_; }

 private:
  void add_entry(ModuleEntry entry);
  const ModuleEntry& require(const std::string& kind, const std::string& name) const;

  std::map<std::string, std::map<std::string, ModuleEntry>> entries_;
  std::string origin_ = "built in";
};

/// Settings of a module that has none.
struct NoSettings {
  static void describe(ParameterTable<NoSettings>&) {}
};

}  // namespace holdfast
