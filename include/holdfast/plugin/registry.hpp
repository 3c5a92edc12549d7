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

/// Description of a module for the generated reference.
struct ModuleDescription {
  std::string name = {};     ///< key in the configuration: lower case, words joined by _
  std::string summary = {};  ///< one sentence
  std::string paper = {};    ///< the publication that it implements; empty if there is none
  std::string licence = "BSD-3-Clause";
};

/// A registered module: its description, its parameter table and its factory function.
struct ModuleEntry {
  std::string kind;  ///< the section of the configuration: source, features, ...
  ModuleDescription description;
  std::string origin;  ///< "built in" or the path of the plugin
  std::vector<Parameter> parameters;
  std::function<std::unique_ptr<Module>(const ParameterValues&, const CreationContext&)> create;
};

/// All modules that a configuration can select, by kind and name. It is a value and not a global: two registries in one
/// process are independent. Not synchronised.
class Registry {
 public:
  /// Registers a module. Interface is one of interfaces/*.hpp, which defines the kind; Settings is a struct with
  /// describe(). Throws PluginError if a module of this kind and name is already registered.
  template <class Interface, class Settings>
  void add(ModuleDescription description,
           std::function<std::unique_ptr<Interface>(const Settings&, const CreationContext&)> create) {
    auto table = std::make_shared<const ParameterTable<Settings>>();
    ModuleEntry entry{Interface::kind, std::move(description), origin_, table->parameters(), {}};
    entry.create = [table, create = std::move(create)](const ParameterValues& values, const CreationContext& context) {
      return std::unique_ptr<Module>(create(table->settings(values), context));
    };
    add(std::move(entry));
  }

  /// Registers a module that has a constructor Implementation(const Settings&, const CreationContext&).
  template <class Interface, class Implementation, class Settings>
  void add(ModuleDescription description) {
    add<Interface, Settings>(std::move(description), [](const Settings& settings, const CreationContext& context) {
      return std::unique_ptr<Interface>(std::make_unique<Implementation>(settings, context));
    });
  }

  /// Registers an entry whose parameter table is known at run time only, such as that of a module in another language;
  /// its origin stays as given. Throws PluginError if a module of this kind and name is already registered.
  void add(ModuleEntry entry);

  const ModuleEntry* find(const std::string& kind, const std::string& name) const;
  /// Entries of a kind, sorted by name.
  std::vector<const ModuleEntry*> of_kind(const std::string& kind) const;
  /// Kinds with at least one module, sorted.
  std::vector<std::string> kinds() const;
  /// Names of a kind's modules, sorted.
  std::vector<std::string> names(const std::string& kind) const;

  /// Records a built-in module that is not part of this build; `option` is the CMake option that enables it.
  void add_left_out(const std::string& kind, const std::string& name, const std::string& option);
  /// Records a registered module that is not usable in this build; `reason` states the cause and the remedy.
  void add_unusable(const std::string& kind, const std::string& name, const std::string& reason);
  /// Cause and remedy for a module that is missing or not usable in this build; empty for any other name.
  std::string absence(const std::string& kind, const std::string& name) const;
  /// Names of a kind's modules that were left out of this build, sorted.
  std::vector<std::string> left_out(const std::string& kind) const;
  /// Suggestion for an unknown name of a kind, for messages: the CMake option for a module that was left out of this
  /// build, otherwise the similar names.
  std::string suggestion(const std::string& kind, const std::string& name) const;

  /// Creates a module. The values must have passed the checks of its parameter table. Throws PluginError for an unknown
  /// name; exceptions of the module's constructor are propagated.
  template <class Interface>
  std::unique_ptr<Interface> create(const std::string& name, const ParameterValues& values,
                                    const CreationContext& context) const {
    const ModuleEntry& entry = require(Interface::kind, name);
    return std::unique_ptr<Interface>(static_cast<Interface*>(entry.create(values, context).release()));
  }

  /// Sets the origin of the modules that are added next; called by the plugin loader.
  void set_origin(std::string origin) { origin_ = std::move(origin); }
  const std::string& origin() const { return origin_; }

 private:
  const ModuleEntry& require(const std::string& kind, const std::string& name) const;

  std::map<std::string, std::map<std::string, ModuleEntry>> entries_;
  std::map<std::string, std::map<std::string, std::string>> left_out_;  // kind, name and CMake option
  std::map<std::string, std::string> unusable_;                         // "kind/name" and reason
  std::string origin_ = "built in";
};

/// Settings of a module without parameters.
struct NoSettings {
  static void describe(ParameterTable<NoSettings>&) {}
};

}  // namespace holdfast
