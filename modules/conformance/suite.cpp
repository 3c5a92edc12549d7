// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/conformance/suite.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <exception>
#include <utility>

#include "check.hpp"
#include "crash_note.hpp"
#include "holdfast/config/parameter_reader.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/plugin/did_you_mean.hpp"
#include "holdfast/plugin/loader.hpp"

namespace holdfast::conformance {

namespace {

struct KindOfModule {
  const char* kind;
  std::vector<Check> (*checks)();
};
constexpr KindOfModule kinds[] = {{"features", feature_extractor_checks}, {"matcher", feature_matcher_checks},
                                  {"segmenter", segmenter_checks},        {"filters", dynamic_filter_checks},
                                  {"optimizer", optimizer_checks},        {"loop_detector", loop_detector_checks},
                                  {"source", frame_source_checks},        {"observers", observer_checks}};

std::vector<std::string> kind_names() {
  std::vector<std::string> names;
  for (const KindOfModule& kind : kinds) names.emplace_back(kind.kind);
  return names;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// One check of one module.
class ConformanceTest : public testing::Test {
 public:
  ConformanceTest(Check check, std::shared_ptr<const Maker> maker, std::string suite)
      : check_(check), maker_(std::move(maker)), suite_(std::move(suite)) {}

  void TestBody() override {
    const std::string promise =
        suite_ + " is held to " + check_.promise.header + ": \"" + check_.promise.sentence + "\"";
    SCOPED_TRACE(promise);
    const CrashNote note("\nThe module crashed in " + suite_ + "." + check_.name + ". " + promise + "\n");
    try {
      check_.run(*maker_);
    } catch (const Error& error) {
      ADD_FAILURE() << "The module refused what it must accept, or could not be made: " << error.what();
    } catch (const std::exception& error) {
      ADD_FAILURE() << "The module threw something that is no holdfast::Error: " << error.what();
    }
  }

 private:
  Check check_;
  std::shared_ptr<const Maker> maker_;
  std::string suite_;
};

void add_checks(const std::vector<Check>& checks, const std::string& suite, const std::shared_ptr<const Maker>& maker) {
  for (const Check& check : checks)
    testing::RegisterTest(suite.c_str(), check.name, nullptr, nullptr, __FILE__, __LINE__,
                          [=]() -> testing::Test* { return new ConformanceTest(check, maker, suite); });
}

/// The parameters given for a module, or nothing.
class GivenParameters {
 public:
  GivenParameters(const Subject& subject, const Registry& registry, std::vector<Diagnostic>& diagnostics)
      : diagnostics_(diagnostics) {
    if (subject.parameters.empty()) return;
    root_ = parse_yaml(subject.parameters, subject.parameters_name, subject.folder);
    if (root_.kind == ConfigurationNode::Kind::nothing) return;
    if (!is_map(root_, "expected kinds, such as segmenter: { mine: { ... } }")) return;
    for (const ConfigurationNode::Entry& kind : root_.entries) {
      const std::vector<std::string> known = kind_names();
      if (std::find(known.begin(), known.end(), kind.key) == known.end()) {
        complain(kind.location, "there are no tests for '" + kind.key + "'; " + did_you_mean(kind.key, known));
        continue;
      }
      if (!is_map(kind.value, "expected modules with their parameters, such as { mine: { ... } }")) continue;
      for (const ConfigurationNode::Entry& module : kind.value.entries)
        if (registry.find(kind.key, module.key) == nullptr)
          complain(module.location, "the plugin has no " + kind.key + " module '" + module.key + "'; " +
                                        did_you_mean(module.key, registry.names(kind.key)));
    }
  }

  /// Checks parameters with the module's table and adds errors to the diagnostics. A missing required parameter is
  /// reported by the module's own test.
  ParameterValues values(const ModuleEntry& entry) const {
    const ConfigurationNode* kind = root_.find(entry.kind);
    const ConfigurationNode* given = kind == nullptr ? nullptr : kind->find(entry.description.name);
    std::vector<Parameter> table = entry.parameters;
    if (given == nullptr)
      for (Parameter& parameter : table) parameter.is_required = false;
    return read_parameters(given == nullptr ? ConfigurationNode{} : *given, table,
                           entry.kind + " '" + entry.description.name + "'", diagnostics_);
  }

 private:
  bool is_map(const ConfigurationNode& node, const std::string& expected) const {
    if (node.kind == ConfigurationNode::Kind::map) return true;
    complain(node.location, "found " + node.found() + "; " + expected);
    return false;
  }
  void complain(const SourceLocation& location, const std::string& message) const {
    diagnostics_.push_back({location, message});
  }

  ConfigurationNode root_;
  std::vector<Diagnostic>& diagnostics_;
};

/// Whether one of the names, each `name` or `kind/name`, means this module, whose full name is given.
bool is_named(const std::string& full_name, const std::vector<std::string>& names) {
  return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
    return name == full_name || name == full_name.substr(full_name.find('/') + 1);
  });
}

}  // namespace

void add_tests(const Subject& subject) {
  auto registry = std::make_shared<Registry>();
  if (subject.register_modules != nullptr)
    subject.register_modules(*registry);
  else
    load_plugin(*registry, subject.plugin.string());

  std::vector<Diagnostic> diagnostics;
  const GivenParameters given(subject, *registry, diagnostics);
  std::vector<std::string> names;
  std::vector<std::function<void()>> additions;
  for (const KindOfModule& kind : kinds)
    for (const ModuleEntry* entry : registry->of_kind(kind.kind)) {
      names.push_back(std::string(kind.kind) + "/" + entry->description.name);
      if (!subject.modules.empty() && !is_named(names.back(), subject.modules)) continue;
      if (is_named(names.back(), subject.except)) continue;
      const auto maker = std::make_shared<const Maker>(registry, *entry, given.values(*entry));
      additions.emplace_back([=, checks = kind.checks, suite = names.back()] {
        add_checks(module_checks(), suite, maker);
        add_checks(checks(), suite, maker);
      });
    }
  for (const auto* wanted : {&subject.modules, &subject.except})
    for (const std::string& each : *wanted)
      if (std::none_of(names.begin(), names.end(), [&](const std::string& name) { return is_named(name, {each}); }))
        diagnostics.push_back(
            {{}, "the plugin has no module '" + each + "' that can be tested; " + did_you_mean(each, names)});
  if (!diagnostics.empty()) throw ConfigurationError(std::move(diagnostics));
  if (additions.empty())
    throw PluginError("plugin '" + subject.plugin.string() + "' has no module that can be tested; expected one of " +
                      listed(kind_names()));
  for (const auto& add : additions) add();
}

std::vector<CheckDescription> catalogue() {
  std::vector<CheckDescription> all;
  const auto add = [&](const std::string& kind, const std::vector<Check>& checks) {
    for (const Check& check : checks) all.push_back({kind, check.name, check.promise});
  };
  add("module", module_checks());
  for (const KindOfModule& kind : kinds) add(kind.kind, kind.checks());
  return all;
}

}  // namespace holdfast::conformance
