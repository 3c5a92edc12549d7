// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "holdfast/plugin/builtin.hpp"
#include "holdfast/plugin/registry.hpp"

namespace holdfast {

/// The modules of this build.
inline Registry builtin_modules() {
  Registry registry;
  register_builtin_plugins(registry);
  return registry;
}

/// What hosts the program: its own executable, or another one such as Python's interpreter.
struct ProgramHost {
  /// The modules that a configuration can select without naming a plugin. Called by the thread of run_program().
  std::function<Registry()> modules = builtin_modules;
  /// Command line that starts the program once more, without its arguments, for the runs of `bench`. Empty: this
  /// executable.
  std::vector<std::string> command = {};
};

}  // namespace holdfast
