// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "holdfast/plugin/registry.hpp"

/// Tests that any extractor, segmenter, filter, optimizer or loop detector must pass, whoever wrote it. Link
/// holdfast::conformance, or let holdfast_conformance_test() write the program (docs/conformance.md).
namespace holdfast::conformance {

/// A sentence of a header that a check holds a module to, as it stands there.
struct Promise {
  const char* header;
  const char* sentence;
};

/// What is tested: the modules of one plugin.
struct Subject {
  void (*register_modules)(Registry&) = nullptr;  ///< entry of a plugin that is linked in; nullptr: `plugin`
  std::filesystem::path plugin = {};              ///< file of a shared plugin
  std::vector<std::string> modules = {};          ///< as `name` or `kind/name`; empty: all that can be tested
  std::vector<std::string> except = {};           ///< and not these
  /// YAML, kind by kind and name by name: `segmenter: { mine: { dilate: 3 } }`. What is not named keeps its defaults.
  std::string parameters = {};
  std::string parameters_name = "PARAMETERS";  ///< names them in messages
  std::filesystem::path folder = {};           ///< relative paths in them start here
};

/// Adds one GoogleTest per module and check, called KIND/MODULE.CHECK; call it between InitGoogleTest() and
/// RUN_ALL_TESTS(). Throws PluginError for a plugin that cannot be loaded or has nothing to test, and
/// ConfigurationError with everything that is wrong with the modules and parameters named.
void add_tests(const Subject& subject);

/// One check, for lists.
struct CheckDescription {
  std::string kind;  ///< section of the configuration; "module" for those that every module gets
  std::string name;
  Promise promise;
};
/// Every check there is, in the order in which they run.
std::vector<CheckDescription> catalogue();

}  // namespace holdfast::conformance
