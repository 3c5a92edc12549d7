// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "holdfast/plugin/registry.hpp"

/// Tests that every extractor, segmenter, filter, optimizer and loop detector must pass. Link holdfast::conformance, or
/// let holdfast_conformance_test() generate the program (docs/conformance.md).
namespace holdfast::conformance {

/// The sentence of a header that a check verifies, quoted literally.
struct Promise {
  const char* header;
  const char* sentence;
};

/// Selects the modules of one plugin for the tests.
struct Subject {
  void (*register_modules)(Registry&) = nullptr;  ///< entry function of a linked plugin; nullptr: use `plugin`
  std::filesystem::path plugin = {};              ///< file of a shared plugin
  std::vector<std::string> modules = {};          ///< `name` or `kind/name`; empty = all testable modules
  std::vector<std::string> except = {};           ///< modules to exclude
  /// Parameters as YAML by kind and name: `segmenter: { mine: { dilate: 3 } }`. Other modules use their defaults.
  std::string parameters = {};
  std::string parameters_name = "PARAMETERS";  ///< name of `parameters` in messages
  std::filesystem::path folder = {};           ///< base folder of relative paths in `parameters`
};

/// Registers one GoogleTest per module and check, named KIND/MODULE.CHECK. It must be called between InitGoogleTest()
/// and RUN_ALL_TESTS(). Throws PluginError for a plugin that cannot be loaded or has no testable module, and
/// ConfigurationError with all errors in the selected modules and parameters.
void add_tests(const Subject& subject);

/// Description of one check.
struct CheckDescription {
  std::string kind;  ///< section of the configuration; "module" for checks of all modules
  std::string name;
  Promise promise;
};
/// All checks in the order of execution.
std::vector<CheckDescription> catalogue();

}  // namespace holdfast::conformance
